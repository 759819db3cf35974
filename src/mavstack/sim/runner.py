"""Runs a simulation by the event loop's clock, and joins its vehicles to links.

    runner = Runner(simulation, speed=1)
    await runner.connect("udpout://127.0.0.1:14550", simulation.vehicles)
    await runner.run()

A link may carry one vehicle or many: what comes in goes to the vehicles that it is addressed to. With a
`speed` of 2 two simulated seconds pass in a real one; with an infinite one time passes as fast as it can. A
speed that is set while it runs counts from then on. If the machine cannot keep up, simulated time falls
behind rather than jump, and `lag` tells by how much.
A loop in virtual time (see `virtual`) makes the whole virtual.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from math import ceil, inf, isinf
from typing import TYPE_CHECKING

from mavstack.dialects import Dialect
from mavstack.errors import LinkClosedError, LinkError, MavstackError
from mavstack.links import BytesReceived, Channel, ChannelClosed, ChannelOpened, Link, LinkDown, open_link
from mavstack.services.addressing import target_of
from mavstack.sim.simulation import ROUNDING
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.links import LinkEvent
    from mavstack.sim.port import Port
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle

#: Simulated time is given up beyond so many seconds behind: the machine slept, or is too slow.
MOST_LAG = 0.5
#: So many steps are made at most before the links have their turn: what came in while the machine was busy
#: must not find that the vehicle's patience has ended meanwhile.
STEPS_AT_ONCE = 5
#: Packets of a log or a file that peers are sent in a real second, as simulators of the firmwares do: those
#: who are slower would lose most of them.
BULK_RATE = 1000.0


@dataclass(eq=False, slots=True)
class _Mooring:
    """One channel of a link, and the port that each vehicle has on it."""

    channel: Channel
    pace: int  # of its link, in bytes a real second; 0 if it is not known
    ports: dict[SimulatedVehicle, Port]
    parser: Parser | None  # for finding out to whom a packet is addressed; None for a single vehicle


class Runner:
    """The clock and the links of a simulation."""

    def __init__(
        self,
        simulation: Simulation,
        *,
        speed: float = 1.0,
        on_link_down: Callable[[Link, str], None] | None = None,
    ) -> None:
        self.simulation = simulation
        self._moorings: dict[Channel, _Mooring] = {}
        self.speed = speed
        self.links: list[Link] = []
        #: Simulated seconds that were given up because the machine could not keep up.
        self.lag = 0.0
        self._on_link_down = on_link_down
        self._dialect = Dialect.load("all")
        self._channels: dict[Port, Channel] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    @property
    def speed(self) -> float:
        """Simulated seconds in a real one."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        if not speed > 0:
            raise MavstackError(f"a simulation cannot run at a speed of {speed}")
        self._speed = speed
        for mooring in self._moorings.values():
            for port in mooring.ports.values():
                port.limit(*self._limits(mooring.pace))

    def _limits(self, pace: int) -> tuple[float | None, float | None]:
        """Bandwidth and rate of bulk: what a real second carries is spread over `speed` simulated ones."""
        if isinf(self._speed):
            return pace or None, None
        return pace / self._speed or None, BULK_RATE / self._speed

    async def connect(self, link: str | Link, vehicles: Iterable[SimulatedVehicle]) -> Link:
        """Open a link for these vehicles; raises `LinkError` if it cannot be."""
        opened = open_link(link) if isinstance(link, str) else link
        await opened.open()
        self.links.append(opened)
        task = asyncio.get_running_loop().create_task(self._read(opened, tuple(vehicles)))
        self._tasks.add(task)
        task.add_done_callback(self._ended)
        return opened

    def start(self) -> asyncio.Task[None]:
        """Let time pass in the background until `close`."""
        task = asyncio.get_running_loop().create_task(self.run())
        self._tasks.add(task)
        return task

    async def run(self, seconds: float | None = None) -> None:
        """Let time pass, for so many simulated seconds (whole steps) or until cancelled."""
        length = self.simulation.length
        end = inf if seconds is None else self.simulation.now + ceil(seconds / length) * length - ROUNDING
        while self.simulation.now < end:
            if isinf(self.speed):
                await self._run_freely(end)
            else:
                await self._run_by_clock(end)

    async def close(self) -> None:
        """Stop, and close the links; an error that stopped the vehicles in the background is raised here."""
        tasks = tuple(self._tasks)
        self._tasks.clear()
        for task in tasks:
            task.cancel()
        endings = await asyncio.gather(*tasks, return_exceptions=True)
        for link in self.links:
            await link.close()
        for channel in tuple(self._moorings):
            self._part(channel)
        for ending in endings:
            if isinstance(ending, Exception):
                raise ending

    def _ended(self, task: asyncio.Task[None]) -> None:
        """A link was read to its end; the task stays if it ended with an error, for `close` to tell."""
        if task.cancelled() or task.exception() is None:
            self._tasks.discard(task)

    async def _run_freely(self, end: float) -> None:
        simulation = self.simulation
        while simulation.now < end and isinf(self.speed):
            due = simulation.now + STEPS_AT_ONCE * simulation.length
            simulation.advance(min(due, end + ROUNDING))
            self.flush()
            await asyncio.sleep(0)

    async def _run_by_clock(self, end: float) -> None:
        loop, simulation = asyncio.get_running_loop(), self.simulation
        looked_at, owed = loop.time(), 0.0  # simulated seconds that the clock is ahead
        while simulation.now < end and not isinf(self.speed):
            before, now = looked_at, loop.time()
            looked_at = now
            owed += (now - before) * self.speed
            behind = owed - MOST_LAG * max(self.speed, 1.0)
            if behind > 0:
                self.lag += behind
                owed -= behind
            begun = simulation.now
            due = begun + min(owed, STEPS_AT_ONCE * simulation.length)
            simulation.advance(min(due, end + ROUNDING))
            owed -= simulation.now - begun
            self.flush()
            await asyncio.sleep(max((simulation.length - owed) / self.speed - loop.time() + now, 0.0))

    def flush(self) -> None:
        """Send what the vehicles have to say."""
        for vehicle in self.simulation.vehicles:
            self._flush(vehicle)

    def _flush(self, vehicle: SimulatedVehicle) -> None:
        for port, data in vehicle.data_to_send():
            channel = self._channels.get(port)
            if channel is not None and not channel.closed:
                try:
                    channel.write(data)
                except LinkClosedError:
                    continue  # its ChannelClosed is on the way

    async def _read(self, link: Link, vehicles: Sequence[SimulatedVehicle]) -> None:
        try:
            async for batch in link.batches():
                for event in batch:
                    self._take(link, vehicles, event)
                for vehicle in vehicles:
                    self._flush(vehicle)
        except LinkError as error:
            if self._on_link_down is not None:
                self._on_link_down(link, str(error))

    def _take(self, link: Link, vehicles: Sequence[SimulatedVehicle], event: LinkEvent) -> None:
        match event:
            case BytesReceived(channel, data):
                self._received(self._moorings[channel], data)
            case ChannelOpened(channel):
                bandwidth, bulk_rate = self._limits(link.pace)
                ports = {
                    vehicle: vehicle.open_port(channel.name, bandwidth=bandwidth, bulk_rate=bulk_rate)
                    for vehicle in vehicles
                }
                parser = Parser(self._dialect) if len(vehicles) > 1 else None
                self._moorings[channel] = _Mooring(channel, link.pace, ports, parser)
                self._channels.update(dict.fromkeys(ports.values(), channel))
            case ChannelClosed(channel):
                self._part(channel)
            case LinkDown(reason) if self._on_link_down is not None:
                self._on_link_down(link, reason)

    def _part(self, channel: Channel) -> None:
        """The peer is gone, for all vehicles."""
        for vehicle, port in self._moorings.pop(channel).ports.items():
            del self._channels[port]
            vehicle.close_port(port)

    def _received(self, mooring: _Mooring, data: bytes) -> None:
        if mooring.parser is None:
            for vehicle, port in mooring.ports.items():
                vehicle.receive(port, data)
            return
        for packet in mooring.parser.feed(data):
            system = target_of(packet.message).system if packet.message is not None else 0
            for vehicle, port in mooring.ports.items():
                if system in (0, vehicle.address.system):
                    vehicle.receive(port, packet.raw)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()
