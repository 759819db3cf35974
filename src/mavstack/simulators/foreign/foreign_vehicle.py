"""A vehicle of Mavstack in the world of another simulator, as PX4 or ArduPilot would be there.

    vehicle = ForeignVehicle("px4", to="tcpout://127.0.0.1:4560", links=["udpout://127.0.0.1:14550"])
    async with vehicle:
        await vehicle.run()

The simulator moves the body and sets the time; the autopilot, its services and its links are those of
`mavstack.sim`. With PX4's interface the simulator sets the pace, with ArduPilot's the vehicle.
"""

from __future__ import annotations

import asyncio
import logging
import math
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, Self

from mavstack.dialects import Dialect
from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.rotation import rotate, to_euler
from mavstack.sim.motion.external import ExternalMotion
from mavstack.sim.motion.readings import Motion
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType
from mavstack.simulators.foreign.json_side import JsonSide
from mavstack.simulators.foreign.loops import LOOPS, Loops
from mavstack.simulators.foreign.px4_side import Px4Side
from mavstack.simulators.pace import Pace
from mavstack.simulators.simulator import listen_address
from mavstack.simulators.state import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from types import TracebackType

    from mavstack.links import Link
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.simulators.foreign.sample import ForeignSample

_log = logging.getLogger("mavstack.simulators")
#: Steps of the autopilot per second, and steps per second that are requested over ArduPilot's interface.
RATE, ASK_RATE = 100.0, 400
#: Real seconds between two attempts to connect; seconds without an answer after which a request over
#: ArduPilot's interface is repeated.
RETRY, RESEND = 0.5, 1.0
#: The longest step in seconds; a longer one is a pause of the simulator.
MAX_STEP: Final = 0.25
_CHUNK: Final = 65536


class ForeignVehicle:
    """A simulated vehicle whose body is in another simulator; an asynchronous context manager.

    Args:
        firmware: "px4" or "ardupilot".
        vehicle_type: "copter", "plane", "rover" or "boat".
        to: The simulator: `tcpout://HOST:PORT` for PX4, `udpout://HOST:PORT` for ArduPilot.
        links: URLs or links on which the vehicle speaks MAVLink to clients.
        home: With ArduPilot the place of the simulator's origin; PX4 gets its place from the simulator.
        system: The system id.
        seed: Seed of the autopilot's estimate.
        speed: With ArduPilot simulated seconds in a real second; 0: as fast as the simulator answers.
        on_event: Called with a line when the simulator is connected, and at the next stages.

    Attributes:
        time: Seconds of the simulation.

    Raises:
        InvalidArgumentError: An argument is wrong; the text says which.
    """

    def __init__(
        self,
        firmware: Firmware | str,
        vehicle_type: VehicleType | str = VehicleType.COPTER,
        *,
        to: str,
        links: Iterable[str | Link] = (),
        home: Home = DEFAULT_HOME,
        system: int = 1,
        seed: int = 1,
        speed: float = 0.0,
        on_event: Callable[[str], None] = lambda line: None,
    ) -> None:
        self._firmware, self._type = Firmware(firmware), VehicleType(vehicle_type)
        if self._type not in LOOPS:
            kinds = ", ".join(kind.value for kind in LOOPS)
            raise InvalidArgumentError(f"a {self._type.value} cannot fly in another simulator: {kinds}")
        scheme = "tcpout" if self._firmware is Firmware.PX4 else "udpout"
        self._address = listen_address(to, scheme)
        self._links, self._home, self._system = tuple(links), home, system
        self._report = on_event
        self._simulation = Simulation(seed=seed, rate=RATE)
        self._runner = Runner(self._simulation, speed=math.inf)
        self._loops: Loops = LOOPS[self._type]()
        self._pace = Pace(speed)
        self._px4 = Px4Side(Dialect.load("common"), system)
        self._json = JsonSide(ASK_RATE)
        self._motion: ExternalMotion | None = None
        self._vehicle: SimulatedVehicle | None = None
        self._outputs = self._loops.stop()
        self._last: float | None = None
        self._linked = False
        self.time = 0.0

    @property
    def vehicle(self) -> SimulatedVehicle | None:
        """The simulated vehicle; None: the simulator has not given its place yet."""
        return self._vehicle

    @property
    def status(self) -> str:
        """The event that each side waits for, in a sentence."""
        if self._firmware is Firmware.PX4:
            problems = "; ".join(sorted(self._px4.problems))
            return self._px4.phase.value + (f" ({problems})" if problems else "")
        return self._json.status

    async def run(self, *, until: float | None = None) -> None:
        """Fly until the simulator disconnects.

        Args:
            until: Seconds of the simulation after which it ends; None: no end.
        """
        end = math.inf if until is None else until
        await (self._run_px4(end) if self._firmware is Firmware.PX4 else self._run_ardupilot(end))

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self._runner.close()
        self._simulation.close()

    # PX4: a TCP client that answers

    async def _run_px4(self, end: float) -> None:
        reader, writer = await self._connect()
        self._report("the simulator is connected")
        try:
            writer.write(self._px4.connected())
            while self.time < end and (data := await reader.read(_CHUNK)):
                for sample in self._px4.feed(data):
                    await self._advance(sample)
                    is_armed = self._vehicle is not None and self._vehicle.autopilot.armed
                    writer.write(self._px4.answer(self._outputs, is_armed=is_armed))
        except OSError as error:
            _log.info("the simulator disconnected: %s", error)
        finally:
            writer.close()
            with suppress(OSError):
                await writer.wait_closed()

    async def _connect(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        """Connect; try again until the simulator answers."""
        while True:
            try:
                return await asyncio.open_connection(*self._address)
            except OSError as error:
                _log.debug("the simulator cannot be reached: %s", error)
                await asyncio.sleep(RETRY)

    # ArduPilot: a UDP client that asks

    async def _run_ardupilot(self, end: float) -> None:
        loop = asyncio.get_running_loop()
        answers: asyncio.Queue[bytes] = asyncio.Queue(64)
        host, port = self._address
        try:
            transport, _ = await loop.create_datagram_endpoint(
                lambda: _Answers(answers), remote_addr=(host, port)
            )
        except OSError as error:
            raise LinkError(f"cannot reach udpout://{host}:{port}: {error.strerror or error}") from error
        try:
            await self._place(self._home)
            while self.time < end:
                if delay := self._pace.delay(self.time, loop.time()):
                    await asyncio.sleep(delay)
                transport.sendto(self._json.ask(self._loops.pulses(self._outputs)))
                await self._advance(await self._answer(transport, answers))
        finally:
            transport.close()

    async def _answer(
        self, transport: asyncio.DatagramTransport, answers: asyncio.Queue[bytes]
    ) -> ForeignSample:
        """Wait for the answer, and ask again if none comes."""
        while True:
            try:
                async with asyncio.timeout(RESEND):
                    sample = self._json.feed(await answers.get())
            except TimeoutError:
                transport.sendto(self._json.repeat())
                continue
            if sample is not None:
                if self._json.steps == 1:
                    self._report("the simulator is connected")
                return sample

    # Steps

    async def _place(self, home: Home) -> None:
        """Create the vehicle at its place, and connect its links."""
        self._vehicle = self._simulation.add(self._type, self._firmware, home=home, system=self._system)
        self._motion = ExternalMotion(self._simulation.world, self._vehicle.body)
        for link in self._links:
            await self._runner.connect(link, [self._vehicle])
        self._report("the vehicle is at its place")

    async def _advance(self, sample: ForeignSample | None) -> None:
        """Take a sample, let the autopilot run, and compute the outputs."""
        if sample is None:
            return
        if self._vehicle is None and self._px4.frame is not None:
            frame = self._px4.frame
            await self._place(Home(frame.latitude, frame.longitude, frame.altitude, 0.0))
        vehicle, motion = self._vehicle, self._motion
        if vehicle is None or motion is None:
            return
        last, self._last = self._last, sample.time
        dt = min(max(sample.time - last, 0.0), MAX_STEP) if last is not None else 0.0
        self.time += dt
        motion.set(_motion_of(sample))
        self._simulation.advance(self._simulation.now + self.time - self._simulation.elapsed)
        self._runner.flush()
        if vehicle.body.running:
            self._outputs = self._loops.step(sample, motion.demand, dt)
        else:
            self._outputs = self._loops.stop()
        await asyncio.sleep(0)  # let clients and the simulator run


class _Answers(asyncio.DatagramProtocol):
    """Keeps the newest answers."""

    def __init__(self, answers: asyncio.Queue[bytes]) -> None:
        self._answers = answers

    def datagram_received(self, data: bytes, addr: tuple[Any, ...]) -> None:
        if self._answers.full():
            self._answers.get_nowait()
        self._answers.put_nowait(data)

    def error_received(self, exc: Exception) -> None:
        """Ignore that the simulator does not listen yet."""


def _motion_of(sample: ForeignSample) -> Motion:
    north, east, down = rotate(sample.attitude, sample.force)
    return Motion(
        *sample.position,
        *sample.velocity,
        north,
        east,
        down + GRAVITY,
        *to_euler(sample.attitude),
        *sample.rates,
    )
