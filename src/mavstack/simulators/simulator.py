"""Simulators: physics and sensors behind the socket that a firmware expects.

    simulator = Px4Simulator("copter", listen="tcpin://127.0.0.1:4560", speed=0)
    async with simulator:
        await simulator.run(until=60)        # simulated seconds

PX4 connects by TCP and is paced here; ArduPilot asks by UDP and paces itself.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, Self

from mavstack.dialects import Dialect
from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.links import parse_url
from mavstack.simulators.ardupilot import JsonInterface
from mavstack.simulators.pace import Pace
from mavstack.simulators.physics import load_physics
from mavstack.simulators.px4 import STEP, Phase, Px4Interface
from mavstack.simulators.sensors import Sensors

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.state import State

_log = logging.getLogger("mavstack.simulators")
#: Seconds to wait for an answer of PX4 before it drives its outputs.
START_UP_WAIT: Final = 0.02
#: Real seconds without an answer in lockstep after which a line tells so.
SILENCE: Final = 5.0
_CHUNK: Final = 65536
PX4_PORT, ARDUPILOT_PORT = 4560, 9002


class Px4Simulator:
    """Simulates the world of one PX4.

    Args:
        physics: The name of the physics; see `load_physics`.
        home: The place and heading of the vehicle at the start.
        listen: Where PX4 connects, `tcpin://HOST:PORT`.
        speed: Simulated seconds in a real second; 0: as fast as PX4 answers.
        seed: Seed of the sensors' noise.
        on_connect: Called with a line when PX4 connects and when it answers for the first time.

    Raises:
        InvalidArgumentError: An argument is wrong; the text says which.
    """

    def __init__(
        self,
        physics: str,
        *,
        home: Home,
        listen: str = f"tcpin://127.0.0.1:{PX4_PORT}",
        speed: float = 1.0,
        seed: int = 1,
        on_connect: Callable[[str], None] = lambda line: None,
    ) -> None:
        self._address = _address(listen, "tcpin")
        self._physics, self._outputs = load_physics(physics)
        self._home, self._report = home, on_connect
        self.pace = Pace(speed)
        self.sensors = Sensors(home, seed)
        self.interface = Px4Interface(Dialect.load("common"), self.sensors)
        self.state: State = self._physics.reset(home, home.heading).checked()
        self._connection: asyncio.Future[tuple[asyncio.StreamReader, asyncio.StreamWriter]]
        self._server: asyncio.Server | None = None
        self._writers: list[asyncio.StreamWriter] = []
        self._port = 0

    @property
    def time(self) -> float:
        """Seconds of the simulation."""
        return self.interface.steps * STEP * 1e-6

    @property
    def port(self) -> int:
        """The port on which it listens."""
        return self._port

    async def __aenter__(self) -> Self:
        self._connection = asyncio.get_running_loop().create_future()
        host, port = self._address
        try:
            self._server = await asyncio.start_server(self._accept, host, port)
            self._port = int(self._server.sockets[0].getsockname()[1])
        except OSError as error:
            raise LinkError(f"cannot listen on tcpin://{host}:{port}: {error.strerror or error}") from error
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._server is not None:
            self._server.close()
        for writer in self._writers:
            writer.close()
            with suppress(OSError):
                await writer.wait_closed()

    async def run(self, until: float | None = None) -> None:
        """Wait for PX4, and simulate.

        Args:
            until: Seconds of the simulation after which it ends; None: when PX4 disconnects.

        Raises:
            LinkError: PX4 disconnected before that time.
        """
        reader, writer = await self._connection
        self.interface.connected()
        self._report("PX4 is connected; it waits for sensors and starts")
        while until is None or self.time < until:
            await self.pace.wait(self.time)
            writer.write(self.interface.step(self.state))
            if not await self._answered(reader):
                if until is None:
                    return
                raise LinkError(
                    f"PX4 disconnected after {self.time:.3f} s; it and the simulator start again together"
                )
            actuators = self._outputs.of_controls(self.interface.controls)
            self.state = self._physics.step(actuators, STEP * 1e-6).checked()

    def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._writers.append(writer)
        if self._connection.done():
            _log.warning("a second program connected and was refused: each PX4 needs a simulator of its own")
            writer.close()
            return
        self._connection.set_result((reader, writer))

    async def _answered(self, reader: asyncio.StreamReader) -> bool:
        """Wait for the answer to a step; returns False if PX4 disconnected."""
        starts = self.interface.phase is Phase.START_UP
        while True:
            try:
                async with asyncio.timeout(START_UP_WAIT if starts else SILENCE):
                    data = await reader.read(_CHUNK)
            except TimeoutError:
                if starts:
                    return True
                _log.warning("PX4 has not answered step %d for %g s", self.interface.steps, SILENCE)
                continue
            except OSError:
                return False
            if not data:
                return False
            if self.interface.feed(data):
                if starts:
                    self._report(f"PX4 drives its outputs after {self.time:.2f} s: lockstep")
                return True


class ArduPilotSimulator:
    """Simulates the world of one ArduPilot by its JSON interface.

    Args:
        physics: The name of the physics; see `load_physics`.
        home: The place and heading of the vehicle at the start.
        listen: Where ArduPilot asks, `udpin://HOST:PORT`.
        seed: Seed of the sensors' noise.
        on_connect: Called with a line when ArduPilot was started, first or again.
    """

    def __init__(
        self,
        physics: str,
        *,
        home: Home,
        listen: str = f"udpin://127.0.0.1:{ARDUPILOT_PORT}",
        seed: int = 1,
        on_connect: Callable[[str], None] = lambda line: None,
    ) -> None:
        self._address = _address(listen, "udpin")
        made, outputs = load_physics(physics)
        self.sensors = Sensors(home, seed)
        self._starts, self._report = 0, on_connect
        self.interface = JsonInterface(made, outputs, home, self.sensors, self._started)
        self._transport: asyncio.DatagramTransport | None = None
        self._port = 0
        self._failure: asyncio.Future[None]

    @property
    def state(self) -> State:
        """The state of the body."""
        return self.interface.state

    @property
    def time(self) -> float:
        """Seconds of the simulation since ArduPilot was started."""
        return self.interface.time

    @property
    def port(self) -> int:
        """The port on which it listens."""
        return self._port

    async def __aenter__(self) -> Self:
        loop = asyncio.get_running_loop()
        self._failure = loop.create_future()
        host, port = self._address
        try:
            self._transport, _ = await loop.create_datagram_endpoint(
                lambda: _Datagrams(self), local_addr=(host, port)
            )
            self._port = int(self._transport.get_extra_info("sockname")[1])
        except OSError as error:
            raise LinkError(f"cannot listen on udpin://{host}:{port}: {error.strerror or error}") from error
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._transport is not None:
            self._transport.close()
        self._failure.cancel()

    async def run(self) -> None:
        """Answer until it is cancelled; raises what the physics raised."""
        await self._failure

    def take(self, data: bytes, address: tuple[Any, ...]) -> None:
        """Answer a datagram."""
        try:
            answer = self.interface.answer(data)
        except Exception as error:  # noqa: BLE001 (of a user's physics)
            if not self._failure.done():
                self._failure.set_exception(error)
            return
        if answer is not None and self._transport is not None:
            self._transport.sendto(answer, address)

    def _started(self) -> None:
        self._starts += 1
        self._report("ArduPilot is connected" if self._starts == 1 else "ArduPilot was started again")


class _Datagrams(asyncio.DatagramProtocol):
    def __init__(self, simulator: ArduPilotSimulator) -> None:
        self._simulator = simulator

    def datagram_received(self, data: bytes, addr: tuple[Any, ...]) -> None:
        self._simulator.take(data, addr)


def _address(url: str, scheme: str) -> tuple[str, int]:
    """Return host and port of a URL that must have a scheme."""
    parsed = parse_url(url)
    if parsed.scheme != scheme or parsed.host is None or parsed.port is None:
        raise InvalidArgumentError(f"{url!r} must be {scheme}://HOST:PORT")
    return parsed.host, parsed.port
