"""The runner: it advances a simulation by the event loop's clock and connects its vehicles to links.

    runner = Runner(simulation, speed=1)
    await runner.connect("udpout://127.0.0.1:14550", simulation.vehicles)
    await runner.run()

A link may carry one vehicle or many: a packet reaches the vehicles that it is addressed to. A `speed` of 2
simulates two seconds per second, an infinite one runs as fast as possible; it may be changed at any time. If
the machine is too slow, simulated time falls behind, and `lag` tells by how much. In a loop with virtual time
(see `virtual`) the whole simulation is virtual.
"""

from __future__ import annotations

import asyncio
import logging
from dataclasses import dataclass
from math import ceil, inf, isinf
from typing import TYPE_CHECKING, Any, Protocol

from mavstack.dialects import Dialect
from mavstack.errors import InvalidArgumentError, LinkClosedError, LinkError, LinkURLError
from mavstack.links import BytesReceived, Channel, ChannelClosed, ChannelOpened, Link, LinkDown, open_link
from mavstack.node.link_settings import link_keys
from mavstack.services.addressing import target_of
from mavstack.sim.simulation import ROUNDING
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.links import LinkEvent
    from mavstack.links.settings import Version
    from mavstack.security import SigningKey
    from mavstack.services import Address
    from mavstack.sim.simulation import Simulation

_LOG = logging.getLogger("mavstack.sim")

#: Prefix of the URLs of links that carry MSP.
MSP_PREFIX = "msp+"
#: Maximum backlog in seconds; more simulated time is dropped, for example after the computer was suspended.
MAX_LAG = 0.5
#: Maximum number of steps before the links are served again; with more steps, received packets would wait
#: until timeouts of the vehicle expire.
MAX_STEPS_PER_TURN = 5
#: Maximum number of events of a link that are handled in one turn of the event loop.
EVENTS_PER_TURN = 32
#: Packets of logs and files per second to each peer, as the firmwares' own simulators send; slow receivers
#: would lose most packets of a faster stream.
BULK_RATE = 1000.0


class LinkedVehicle(Protocol):
    """A vehicle that can be connected to links; its ports are its own affair."""

    address: Address
    #: True if the vehicle speaks MSP instead of MAVLink.
    speaks_msp: bool

    def open_port(
        self,
        name: str,
        *,
        key: SigningKey | None,
        version: Version,
        bandwidth: float | None,
        bulk_rate: float | None,
    ) -> Any:  # noqa: ANN401 - ports differ
        """Open a port for a peer."""

    def close_port(self, port: Any) -> None:  # noqa: ANN401
        """Close the port of a peer."""

    def receive(self, port: Any, data: bytes) -> object:  # noqa: ANN401
        """Process data from a peer."""

    def data_to_send(self) -> Sequence[tuple[Any, bytes]]:
        """Return the data sent since the last call, with its ports."""


@dataclass(eq=False, slots=True)
class _ChannelPorts:
    """One channel of a link, and the port of each vehicle on it."""

    channel: Channel
    pace: int  # bytes per second of the link; 0 if unknown
    ports: dict[LinkedVehicle, Any]
    # Parses packets to find the addressed vehicle; None if the link has only one vehicle.
    parser: Parser | None


class Runner:
    """Advances a simulation by the clock, and connects its vehicles to links.

    Use it as an asynchronous context manager, or call `close` at the end.

    Args:
        simulation: The simulation.
        speed: Simulated seconds per second; may be infinite.
        on_link_down: Called with a link that fails, and the reason.

    Raises:
        InvalidArgumentError: The speed is not positive.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        speed: float = 1.0,
        on_link_down: Callable[[Link, str], None] | None = None,
    ) -> None:
        self.simulation = simulation
        self._channel_ports: dict[Channel, _ChannelPorts] = {}
        self.speed = speed
        self.links: list[Link] = []
        #: Simulated seconds that were dropped because the computer was too slow.
        self.lag = 0.0
        self._on_link_down = on_link_down
        self._dialect = Dialect.load("all")
        self._channels: dict[Any, Channel] = {}
        self._keys: dict[Link, SigningKey] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    @property
    def speed(self) -> float:
        """Simulated seconds per second."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        if not speed > 0:
            raise InvalidArgumentError(f"the speed of a simulation must be positive, got {speed}")
        self._speed = speed
        for entry in self._channel_ports.values():
            for port in entry.ports.values():
                port.limit(*self._limits(entry.pace))

    def _limits(self, pace: int) -> tuple[float | None, float | None]:
        """Return bandwidth and rate of bulk packets per simulated second."""
        if isinf(self._speed):
            return pace or None, None
        return pace / self._speed or None, BULK_RATE / self._speed

    async def connect(self, link: str | Link, vehicles: Iterable[LinkedVehicle]) -> Link:
        """Open a link for some vehicles.

        Args:
            link: A link URL or a link. The URL of a flight controller that speaks MSP begins with
                `msp+`, such as `msp+tcpin://127.0.0.1:5761`.
            vehicles: The vehicles that the link carries; MSP has no addresses, so a link of it carries one.

        Returns:
            The open link.

        Raises:
            LinkError: The link cannot be opened.
            LinkURLError: The URL is invalid, or gives ids or heartbeats, which the vehicles have themselves,
                or has another protocol than the vehicles.
            SigningError: The key that the URL names cannot be read.
        """
        vehicles = tuple(vehicles)
        opened = open_link(_transport(link, vehicles)) if isinstance(link, str) else link
        if own := {"id", "heartbeat_rate"}.intersection(opened.settings.given):
            raise LinkURLError(f"{opened.url.redacted}: simulated vehicles do not use the option {min(own)}")
        self._keys |= link_keys([opened])
        await opened.open()
        self.links.append(opened)
        _LOG.info("link %s open", opened.url.redacted)
        task = asyncio.get_running_loop().create_task(self._read(opened, vehicles))
        self._tasks.add(task)
        task.add_done_callback(self._ended)
        return opened

    def start(self) -> asyncio.Task[None]:
        """Run in the background until `close`."""
        task = asyncio.get_running_loop().create_task(self.run())
        self._tasks.add(task)
        return task

    async def run(self, seconds: float | None = None) -> None:
        """Run the simulation.

        Args:
            seconds: Simulated seconds, rounded up to whole steps; None runs until cancelled.
        """
        length = self.simulation.step_length
        end = inf if seconds is None else self.simulation.now + ceil(seconds / length) * length - ROUNDING
        while self.simulation.now < end:
            if isinf(self.speed):
                await self._run_freely(end)
            else:
                await self._run_by_clock(end)

    async def close(self) -> None:
        """Stop, close the links, and raise the error that ended the background run, if any."""
        tasks = tuple(self._tasks)
        self._tasks.clear()
        for task in tasks:
            task.cancel()
        endings = await asyncio.gather(*tasks, return_exceptions=True)
        for link in self.links:
            await link.close()
        for channel in tuple(self._channel_ports):
            self._close_channel(channel)
        for ending in endings:
            if isinstance(ending, Exception):
                raise ending

    def _ended(self, task: asyncio.Task[None]) -> None:
        """Discard a reader that ended; one that failed stays, so that `close` raises its error."""
        if task.cancelled() or task.exception() is None:
            self._tasks.discard(task)

    async def _run_freely(self, end: float) -> None:
        simulation = self.simulation
        while simulation.now < end and isinf(self.speed):
            target = simulation.now + MAX_STEPS_PER_TURN * simulation.step_length
            simulation.advance(min(target, end + ROUNDING))
            self.flush()
            await asyncio.sleep(0)

    async def _run_by_clock(self, end: float) -> None:
        loop, simulation = asyncio.get_running_loop(), self.simulation
        last, due = loop.time(), 0.0  # `due`: seconds by which simulated time is behind the clock
        while simulation.now < end and not isinf(self.speed):
            before, now = last, loop.time()
            last = now
            due += (now - before) * self.speed
            behind = due - MAX_LAG * max(self.speed, 1.0)
            if behind > 0:
                self.lag += behind
                _LOG.debug("%.3f simulated seconds dropped: the machine is too slow", behind)
                due -= behind
            begun = simulation.now
            target = begun + min(due, MAX_STEPS_PER_TURN * simulation.step_length)
            simulation.advance(min(target, end + ROUNDING))
            due -= simulation.now - begun
            self.flush()
            await asyncio.sleep(max((simulation.step_length - due) / self.speed - loop.time() + now, 0.0))

    def flush(self) -> None:
        """Send the pending data of all vehicles."""
        for vehicle in self.simulation.vehicles:
            self._flush(vehicle)
        for controller in self.simulation.flight_controllers:
            self._flush(controller)

    def _flush(self, vehicle: LinkedVehicle) -> None:
        for port, data in vehicle.data_to_send():
            channel = self._channels.get(port)
            if channel is not None and not channel.closed:
                try:
                    channel.write(data)
                except LinkClosedError:
                    continue  # a ChannelClosed event follows

    async def _read(self, link: Link, vehicles: Sequence[LinkedVehicle]) -> None:
        try:
            async for batch in link.batches():
                for start in range(0, len(batch), EVENTS_PER_TURN):
                    for event in batch[start : start + EVENTS_PER_TURN]:
                        self._take(link, vehicles, event)
                    for vehicle in vehicles:
                        self._flush(vehicle)
                    await asyncio.sleep(0)  # a flood of packets must not block the simulation
        except LinkError as error:
            _LOG.warning("link %s down: %s", link.url.redacted, error)
            if self._on_link_down is not None:
                self._on_link_down(link, str(error))

    def _take(self, link: Link, vehicles: Sequence[LinkedVehicle], event: LinkEvent) -> None:
        match event:
            case BytesReceived(channel, data):
                self._received(self._channel_ports[channel], data)
            case ChannelOpened(channel):
                self._open_channel(link, vehicles, channel)
                _LOG.info("channel %s up", channel.name)
            case ChannelClosed(channel):
                _LOG.info("channel %s down", channel.name)
                self._close_channel(channel)
            case LinkDown(reason):
                _LOG.warning("link %s down: %s", link.url.redacted, reason)
                if self._on_link_down is not None:
                    self._on_link_down(link, reason)

    def _open_channel(self, link: Link, vehicles: Sequence[LinkedVehicle], channel: Channel) -> None:
        """Open the port of each vehicle on a channel."""
        bandwidth, bulk_rate = self._limits(link.pace)
        key = self._keys.get(link)
        ports = {
            vehicle: vehicle.open_port(
                channel.name,
                key=key,
                version=link.settings.version or 2,
                bandwidth=bandwidth,
                bulk_rate=bulk_rate,
            )
            for vehicle in vehicles
        }
        parser = Parser(self._dialect) if len(vehicles) > 1 else None
        self._channel_ports[channel] = _ChannelPorts(channel, link.pace, ports, parser)
        self._channels.update(dict.fromkeys(ports.values(), channel))

    def _close_channel(self, channel: Channel) -> None:
        """Close the ports of a channel."""
        for vehicle, port in self._channel_ports.pop(channel).ports.items():
            del self._channels[port]
            vehicle.close_port(port)

    def _received(self, entry: _ChannelPorts, data: bytes) -> None:
        if entry.parser is None:
            for vehicle, port in entry.ports.items():
                vehicle.receive(port, data)
            return
        for packet in entry.parser.feed(data):
            system = target_of(packet.message).system if packet.message is not None else 0
            for vehicle, port in entry.ports.items():
                if system in (0, vehicle.address.system):
                    vehicle.receive(port, packet.raw)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()


def _transport(url: str, vehicles: Sequence[LinkedVehicle]) -> str:
    """Return the URL of the transport, without `msp+`; raises LinkURLError if the protocols differ."""
    if not any(vehicle.speaks_msp for vehicle in vehicles):
        return url
    if not url.startswith(MSP_PREFIX):
        raise LinkURLError(
            f"link URL {url}: a flight controller speaks MSP, so its link is {MSP_PREFIX}{url}"
        )
    if len(vehicles) > 1:
        raise LinkURLError(f"link URL {url}: MSP has no addresses, so each vehicle needs a link of its own")
    return url.removeprefix(MSP_PREFIX)
