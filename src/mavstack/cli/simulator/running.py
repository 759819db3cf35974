"""Running worlds of `mav simulator`: their options, lines and ends."""

from __future__ import annotations

import asyncio
import re
import sys
import time
from contextlib import AsyncExitStack
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import echo, echo_json
from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.geodesy import LocalFrame
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.firmware_session import FirmwareOptions, FirmwareSession, default_home
from mavstack.simulators.hardware_simulator import HardwareSimulator
from mavstack.simulators.physics import vehicle_of

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.simulator import Simulator

#: Metres between the start positions of two instances.
SPACING: Final = 5.0
#: Seconds of real time without a simulation step after which the reason is printed.
STUCK: Final = 5.0
_READY: Final = {
    "px4": "ready: PX4 connects to TCP port {port}",
    "ardupilot": "ready: ArduPilot asks UDP port {port}",
    "betaflight": "ready: Betaflight sends motors to UDP port {port}",
}
_FAULT: Final = re.compile(r"(?P<name>[a-z-]+)(@(?P<begin>[0-9.]+)(\+(?P<duration>[0-9.]+))?)?")


def fly_firmware(arguments: Namespace) -> int:
    """Run `mav simulator px4`, `ardupilot` and `betaflight`."""
    return run_until_signal(_limited(arguments, _fly_all(arguments)))


def fly_hardware(arguments: Namespace) -> int:
    """Run `mav simulator hardware`."""
    return run_until_signal(_limited(arguments, _fly_hardware(arguments)))


async def _limited(arguments: Namespace, flight: object) -> int:
    """Run a flight for the time of --for."""
    try:
        async with asyncio.timeout(arguments.seconds):
            code: int = await flight  # type: ignore[misc]
            return code
    except TimeoutError:
        return 0


async def _fly_all(arguments: Namespace) -> int:
    count = getattr(arguments, "instances", 1)
    if count < 1:
        raise UsageError(f"--instances must be 1 or more, got {count}")
    if count > 1 and arguments.listen:
        raise UsageError("--instances uses the default ports of each instance: leave --listen out")
    reports = [Report(arguments, number if count > 1 else None) for number in range(count)]
    codes = await asyncio.gather(*[_fly_one(arguments, number, each) for number, each in enumerate(reports)])
    return max(codes)


async def _fly_one(arguments: Namespace, number: int, report: Report) -> int:
    options = _options(arguments, number)
    session = FirmwareSession(options, on_event=report.connected, on_line=report.line)
    _inject(session.simulator, arguments.fault)
    async with AsyncExitStack() as stack:
        await stack.enter_async_context(session)
        report.ready(session.simulator, _READY[options.firmware], options.physics or session.vehicle)
        if arguments.web:
            await stack.enter_async_context(_station(session, report))
        watching = asyncio.ensure_future(report.watch(session.simulator))
        stack.callback(watching.cancel)
        return await _run(arguments, session, report)


async def _run(arguments: Namespace, session: FirmwareSession, report: Report) -> int:
    """Run a session until its end; a PX4 that the user starts may come again."""
    while True:
        begun = time.monotonic()
        try:
            await session.run(until=arguments.until)
        except LinkError as error:
            echo(f"{error}", error=True)
            return 1
        if arguments.until is not None:
            report.ended(session.simulator, time.monotonic() - begun, "the simulation ended")
            return 0
        report.ended(session.simulator, time.monotonic() - begun, "PX4 disconnected")
        if session.options.binary is not None:
            return 1


def _options(arguments: Namespace, number: int) -> FirmwareOptions:
    """Return the options of an instance."""
    options = FirmwareOptions(
        arguments.firmware,
        binary=arguments.binary,
        vehicle=arguments.vehicle,
        physics=arguments.physics,
        home=_beside(arguments.home or _default_home(arguments), number),
        listen=arguments.listen,
        speed=arguments.speed,
        seed=arguments.seed + number,
        instance=number,
        folder=arguments.folder and arguments.folder / str(number),
    )
    if arguments.firmware == "betaflight":
        return replace(options, bridge=arguments.bridge, motors=arguments.motors)
    parameters = dict(map(_parameter, arguments.parameter))
    options = replace(options, equipment=tuple(arguments.equipment), parameters=parameters)
    if arguments.firmware == "px4":
        return replace(options, model=arguments.model)
    return replace(options, out=tuple(arguments.out))


def _default_home(arguments: Namespace) -> Home:
    return default_home(arguments.firmware, arguments.vehicle or vehicle_of(arguments.physics))


def _parameter(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        raise UsageError(f"--parameter {text!r} is not NAME=VALUE") from None


def _beside(home: Home, number: int) -> Home:
    """Return the place of an instance."""
    if not number:
        return home
    frame = LocalFrame(home.latitude, home.longitude, home.altitude)
    latitude, longitude, _ = frame.to_global(0.0, SPACING * number, 0.0)
    return home._replace(latitude=latitude, longitude=longitude)


def _inject(simulator: Simulator, faults: list[str]) -> None:
    for text in faults:
        found = _FAULT.fullmatch(text)
        try:
            if found is None:
                raise UsageError(f"--fault {text!r} is not NAME, NAME@BEGIN or NAME@BEGIN+SECONDS")
            duration = found["duration"]
            simulator.inject(
                found["name"],
                after=float(found["begin"] or 0.0),
                duration=None if duration is None else float(duration),
            )
        except (InvalidArgumentError, ValueError) as error:
            raise UsageError(f"--fault {text}: {error}") from None


async def _fly_hardware(arguments: Namespace) -> int:
    report = Report(arguments, None)
    simulator = HardwareSimulator(
        arguments.physics,
        arguments.link,
        firmware=arguments.firmware,
        home=arguments.home or DEFAULT_HOME,
        seed=arguments.seed,
        on_connect=report.connected,
    )
    _inject(simulator, arguments.fault)
    async with simulator:
        report.ready(simulator, f"ready: the link {arguments.link} is the board's", arguments.physics)
        watching = asyncio.ensure_future(report.watch(simulator))
        try:
            await simulator.run(until=arguments.until)
        finally:
            watching.cancel()
    return 0


def _station(session: FirmwareSession, report: Report) -> Station:
    return Station(session.url, report)


class Station:
    """The ground station with the vehicle, as a program beside.

    Args:
        url: The URL of the vehicle.
        report: Prints its lines.
    """

    def __init__(self, url: str, report: Report) -> None:
        from mavstack.simulators.firmware_command import FirmwareCommand
        from mavstack.simulators.firmware_process import FirmwareProcess

        words = (sys.executable, "-m", "mavstack", "web", url, "--port", "0", "--no-browser")
        self._process = FirmwareProcess(FirmwareCommand(words), on_line=report.station)

    async def __aenter__(self) -> None:
        await self._process.__aenter__()

    async def __aexit__(self, *error: object) -> None:
        await self._process.__aexit__(None, None, None)


class Report:
    """Prints what happens, as lines or as JSON.

    Args:
        arguments: The arguments of the command.
        number: The number of the instance; None: there is one.
    """

    def __init__(self, arguments: Namespace, number: int | None) -> None:
        self._json, self._number = arguments.json, number

    def ready(self, simulator: Simulator, line: str, physics: str) -> None:
        """Report that the firmware may connect."""
        text = line.format(port=simulator.port)
        self._print({"event": "ready", "port": simulator.port, "physics": physics}, text)

    def connected(self, line: str) -> None:
        """Report a stage of the conversation."""
        self._print({"event": "connected", "text": line}, line)

    def line(self, line: str) -> None:
        """Report a line of the firmware."""
        self._print({"event": "log", "text": line}, f"| {line}")

    def station(self, line: str) -> None:
        """Report a line of the ground station."""
        self._print({"event": "station", "text": line}, line)

    def ended(self, simulator: Simulator, wall: float, what: str) -> None:
        """Report the end of a run."""
        line = f"{what} after {simulator.time:.1f} s of simulation, {wall:.1f} s of time"
        self._print({"event": "disconnected", "time": simulator.time, "text": line}, line)

    async def watch(self, simulator: Simulator) -> None:
        """Report the reason when a simulation does not advance."""
        last, shown = simulator.time, ""
        while True:
            await asyncio.sleep(STUCK)
            status = simulator.status
            if simulator.time == last and status != shown and not simulator.pace.is_paused:
                shown = status
                echo(f"waiting: {status}", error=True)
            last = simulator.time

    def _print(self, values: dict[str, object], line: str) -> None:
        if self._json:
            instance = {} if self._number is None else {"instance": self._number}
            echo_json({**values, **instance})
        else:
            echo(line if self._number is None else f"{self._number}: {line}")
