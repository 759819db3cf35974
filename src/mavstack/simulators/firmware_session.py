"""A flight of real firmware: its world, its program and the way to its vehicle.

    options = FirmwareOptions("ardupilot", binary="build/sitl/bin/arduplane", vehicle="plane")
    async with FirmwareSession(options) as session:
        async with mavstack.connect(session.url) as connection: ...

ArduPilot's SITL runs only while a client is connected to its first serial port; a router is this client, and
offers the vehicle to others. PX4 sends to port 14540 (and the number of its instance) by itself.
"""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack, suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Self

from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.sim.vehicle_types import DEFAULT_HOME, Home
from mavstack.simulators.ardupilot_simulator import ARDUPILOT_PORT, ArduPilotSimulator
from mavstack.simulators.betaflight_simulator import BETAFLIGHT_PORT, BetaflightSimulator
from mavstack.simulators.firmware_command import (
    PX4_API_PORT,
    VEHICLES,
    FirmwareCommand,
    ardupilot_command,
    betaflight_command,
    px4_command,
)
from mavstack.simulators.firmware_process import FirmwareProcess
from mavstack.simulators.physics import vehicle_of
from mavstack.simulators.px4_simulator import PX4_PORT, Px4Simulator

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path
    from types import TracebackType

    from mavstack.simulators.simulator import Simulator

FIRMWARES: Final = ("px4", "ardupilot", "betaflight")
#: Seconds to wait until Betaflight opens its serial ports; it crashes if it receives a state earlier.
BETAFLIGHT_START: Final = 30.0
_OPENED: Final = "bind port"
#: TCP port of Betaflight's first serial port, which speaks MSP.
_BETAFLIGHT_SERIAL: Final = 5761
#: The default output of the router that offers ArduPilot's serial port to clients; the port depends on the
#: instance.
_ARDUPILOT_OUT: Final = "udpout://127.0.0.1:{port}"
_STATION_PORT: Final = 14550


@dataclass(frozen=True)
class FirmwareOptions:
    """The options of a flight.

    Attributes:
        firmware: "px4", "ardupilot" or "betaflight".
        binary: The program; None: the user starts it.
        vehicle: The kind of the vehicle; None: the one that the physics moves.
        physics: The name of the physics; None: the body of the vehicle.
        home: The place and heading at the start; None: the default one of the vehicle.
        listen: Where the firmware connects; None: its usual port.
        speed: Simulated seconds in a real second; 0: as fast as possible.
        seed: Seed of the sensors' noise.
        instance: The number of the instance, which shifts all ports.
        equipment: Sensors beside the usual ones.
        folder: The folder of the program; None: a temporary one.
        model: PX4's model; None: the one of the vehicle.
        out: URLs where a router offers ArduPilot's vehicle; empty: port 14550 of this machine.
        parameters: Parameters of ArduPilot's first start, or of each start of PX4.
        bridge: What Betaflight's build expects, "gazebo" or "legacy".
        motors: The order of Betaflight's motors, "betaflight" or "gazebo".
    """

    firmware: str
    binary: str | None = None
    vehicle: str | None = None
    physics: str | None = None
    home: Home | None = None
    listen: str | None = None
    speed: float = 1.0
    seed: int = 1
    instance: int = 0
    equipment: tuple[str, ...] = ()
    folder: Path | None = None
    model: str | None = None
    out: tuple[str, ...] = ()
    parameters: Mapping[str, float] = field(default_factory=dict)
    bridge: str = "gazebo"
    motors: str = "betaflight"


class FirmwareSession:
    """A world and, if a program is given, its firmware; use it as an asynchronous context manager.

    Args:
        options: The options.
        on_event: Called with a line when the firmware connects, and at the next stages.
        on_line: Called with each line of the program's output.

    Attributes:
        options: The options.
        simulator: The world.
        vehicle: The kind of the vehicle.

    Raises:
        InvalidArgumentError: An option is wrong; the text says which.
    """

    def __init__(
        self,
        options: FirmwareOptions,
        *,
        on_event: Callable[[str], None] = lambda line: None,
        on_line: Callable[[str], None] = lambda line: None,
    ) -> None:
        if options.firmware not in FIRMWARES:
            raise InvalidArgumentError(f"there is no firmware {options.firmware!r}: {', '.join(FIRMWARES)}")
        self.vehicle = options.vehicle or vehicle_of(options.physics)
        if self.vehicle not in VEHICLES:
            raise InvalidArgumentError(f"there is no vehicle {self.vehicle!r}: {', '.join(VEHICLES)}")
        if options.instance < 0:
            raise InvalidArgumentError(f"the instance must be 0 or more, got {options.instance}")
        home = options.home or default_home(options.firmware, self.vehicle)
        self.options, self._home = options, home
        self.simulator: Simulator = _simulator(options, home, options.physics or self.vehicle, on_event)
        self._on_line = on_line
        self._serves = asyncio.Event()
        self._process: FirmwareProcess | None = None
        self._stack = AsyncExitStack()
        if options.binary is not None:
            self._command(0)  # raises at once if the program is wrong

    @property
    def url(self) -> str:
        """The URL of a link to the vehicle, for a client that starts now."""
        options = self.options
        if options.firmware == "px4":
            return f"udpin://127.0.0.1:{PX4_API_PORT + options.instance}"
        if options.firmware == "betaflight":
            return f"msp+tcp://127.0.0.1:{_BETAFLIGHT_SERIAL}"
        return self._outputs()[0].replace("udpout://", "udpin://").replace("tcpin://", "tcpout://")

    async def run(self, *, until: float | None = None) -> None:
        """Simulate until the firmware ends.

        Args:
            until: Seconds of the simulation after which it ends; None: when the firmware ends.

        Raises:
            LinkError: The program ended by itself.
        """
        tasks: list[asyncio.Future[int | None]] = [asyncio.ensure_future(self._simulate(until))]
        if self._process is not None:
            tasks.append(asyncio.ensure_future(self._process.wait()))
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
        if tasks[0] in done:
            tasks[0].result()
        else:
            raise LinkError(f"the program of {self.options.firmware} ended with code {tasks[1].result()}")

    async def _simulate(self, until: float | None) -> None:
        if self._process is not None and self.options.firmware == "betaflight":
            with suppress(TimeoutError):
                await asyncio.wait_for(self._serves.wait(), BETAFLIGHT_START)
        await self.simulator.run(until=until)

    async def __aenter__(self) -> Self:
        async with AsyncExitStack() as stack:
            await stack.enter_async_context(self.simulator)
            if self.options.binary is not None:
                command = self._command(self.simulator.port)
                self._process = await stack.enter_async_context(
                    FirmwareProcess(command, folder=self.options.folder, on_line=self._take_line)
                )
                if command.serial_port:
                    await self._offer(stack, command.serial_port)
            self._stack = stack.pop_all()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self._stack.aclose()

    def _take_line(self, line: str) -> None:
        if _OPENED in line:
            self._serves.set()
        self._on_line(line)

    def _command(self, port: int) -> FirmwareCommand:
        options = self.options
        binary = options.binary or ""
        if options.firmware == "px4":
            instance = port - PX4_PORT if port else options.instance
            return px4_command(
                binary,
                vehicle=self.vehicle,
                physics=options.physics,
                instance=instance,
                speed=options.speed,
                model=options.model,
                parameters=options.parameters,
            )
        if options.firmware == "betaflight":
            return betaflight_command(binary)
        return ardupilot_command(
            binary,
            home=self._home,
            vehicle=self.vehicle,
            instance=options.instance,
            speed=options.speed,
            port=port or None,
            parameters=options.parameters,
        )

    def _outputs(self) -> tuple[str, ...]:
        port = _STATION_PORT + 10 * self.options.instance
        return self.options.out or (_ARDUPILOT_OUT.format(port=port),)

    async def _offer(self, stack: AsyncExitStack, port: int) -> None:
        """Connect to the first serial port of ArduPilot, and offer its vehicle to others."""
        from mavstack.router.config.model import EndpointConfig, RouterConfig
        from mavstack.router.router import Router

        endpoints = [EndpointConfig("firmware", f"tcpout://127.0.0.1:{port}?wait=yes")]
        endpoints += [EndpointConfig(f"out{number}", url) for number, url in enumerate(self._outputs())]
        await stack.enter_async_context(Router(RouterConfig(tuple(endpoints))))


def default_home(firmware: str, vehicle: str) -> Home:
    """Return where a vehicle is at the start, unless a place is given.

    A submarine of ArduPilot is at sea level: its simulated pressure counts from there, and would be negative.

    Args:
        firmware: The name of the firmware.
        vehicle: The kind of the vehicle.
    """
    is_at_sea = firmware == "ardupilot" and vehicle == "sub"
    return DEFAULT_HOME._replace(altitude=0.0) if is_at_sea else DEFAULT_HOME


def _simulator(
    options: FirmwareOptions, home: Home, physics: str, on_event: Callable[[str], None]
) -> Simulator:
    """Return the world of a firmware."""
    seed, equipment = options.seed, options.equipment
    if options.firmware == "px4":
        return Px4Simulator(
            physics,
            home=home,
            listen=options.listen or f"tcpin://127.0.0.1:{PX4_PORT + options.instance}",
            speed=options.speed,
            seed=seed,
            equipment=equipment,
            on_connect=on_event,
        )
    if options.firmware == "betaflight":
        return BetaflightSimulator(
            physics,
            home=home,
            listen=options.listen or f"udpin://127.0.0.1:{BETAFLIGHT_PORT}",
            bridge=options.bridge,
            motors=options.motors,
            speed=options.speed,
            seed=seed,
            on_connect=on_event,
        )
    return ArduPilotSimulator(
        physics,
        home=home,
        listen=options.listen or f"udpin://127.0.0.1:{ARDUPILOT_PORT + 10 * options.instance}",
        seed=seed,
        equipment=equipment,
        on_connect=on_event,
    )
