"""`mav sim`: simulated vehicles that any ground station, library or script can fly.

Each event of a vehicle is printed in one line. A line on standard input is a fault, which is injected
immediately (see `mavstack.sim.faults`).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from secrets import randbits
from typing import TYPE_CHECKING, Final, TypeVar

from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.link_options import add_link_options, with_link_options
from mavstack.cli.common.options import seconds, system_id
from mavstack.cli.common.output import echo
from mavstack.cli.sim.arguments import (
    count,
    home,
    milliseconds,
    obstacle,
    rangefinder,
    share,
    speed,
    version,
    wind,
)
from mavstack.cli.sim.bootloader import add_bootloader_option, simulate_board
from mavstack.cli.sim.event_printer import EventPrinter
from mavstack.cli.sim.flight_controllers import DEFAULT_OUT as DEFAULT_MSP_OUT
from mavstack.cli.sim.flight_controllers import PREFIX, controller_firmwares, transports
from mavstack.cli.sim.video import add_video_option, filming
from mavstack.sim.vehicle_types import DEFAULT_HOME, ControllerFirmware, Firmware, TerrainSource, VehicleType

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Sequence

    from mavstack.links import Link
    from mavstack.sim.faults import FaultScript
    from mavstack.sim.msp import SimulatedFlightController
    from mavstack.sim.runner import Runner
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle

Kind = TypeVar("Kind", VehicleType, Firmware)

EXAMPLES: Final = """\
examples:
  mav sim                                     # an ArduPilot copter for a ground station on this machine
  mav sim --type plane --firmware px4         # a PX4 plane
  mav sim --type copter,rover --count 10      # ten vehicles, copters and rovers in turn, on one port
  mav sim --count 3 --each --out tcpin://0.0.0.0:5760       # one port per vehicle: 5760, 5761, 5762
  mav sim --loss 0.1 --latency 200            # over a bad radio link
  mav sim --radio sik                         # over a slow telemetry radio that reports RADIO_STATUS
  mav sim --home 51.4934,-0.0098,20,90 --wind 6,270,0.2     # at Greenwich, in a gusty west wind
  mav sim --fault "30 gps off" --fault "60 battery sag 3"   # with faults after 30 and 60 s
  mav sim --speed 10                          # ten times as fast
  mav sim --storage flights                   # keep logs and files in a folder
  mav sim --camera --gimbal                   # with a camera and a gimbal
  mav sim --video                             # whose camera streams H.264: rtsp://127.0.0.1:8554/camera
  mav sim --rangefinder forward --obstacle 30,0,2,15   # a rangefinder, and a cylinder 30 m north of home
  mav sim --firmware betaflight --out msp+tcpin://127.0.0.1:5761   # a racing drone that speaks MSP
  mav sim --firmware inav --out msp+pty:///tmp/ttyINAV             # iNav on a serial port of this machine
  mav sim --bootloader px4 --out pty:///tmp/ttyBL                  # a board without firmware, to flash

Fly it from another terminal:
  mavproxy.py --master=udpin:0.0.0.0:14550
  mav watch udpin://0.0.0.0:14550

While it runs, type a fault and Enter: gps off, gps on, compass 90, motor 1 off, battery 15, link off, reboot.
A system id before the fault selects one vehicle: "2: gps off".
"""

#: The ports of ground stations and of MAVSDK programs.
DEFAULT_OUT: Final = ("udpout://127.0.0.1:14550", "udpout://127.0.0.1:14540")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    names, firmwares = ", ".join(VehicleType), ", ".join((*Firmware, *ControllerFirmware))
    add = parser.add_argument
    add("--type", default="copter", metavar="TYPE", help=f"{names}; several in turn: copter,plane")
    add("--firmware", default="ardupilot", metavar="NAME", help=f"{firmwares}; several in turn")
    add("--count", type=count, default=1, metavar="N", help="number of vehicles (default: 1)")
    add("--system", type=system_id, default=1, metavar="ID", help="system id of the first one (default: 1)")
    add(
        "--home",
        type=home,
        default=DEFAULT_HOME,
        metavar="LAT,LON,ALT,HDG",
        help="home of the first vehicle: degrees, metres above sea, heading in degrees",
    )
    add("--camera", action="store_true", help="give each vehicle a camera (component id 100)")
    add_video_option(parser)
    add("--gimbal", action="store_true", help="give each vehicle a gimbal, managed by its autopilot")
    add(
        "--rangefinder",
        action="append",
        type=rangefinder,
        default=[],
        metavar="ORIENTATION[:KIND]",
        help="rangefinder of each vehicle, such as downward:sonar or forward; may be repeated",
    )
    add(
        "--terrain",
        choices=[source.value for source in TerrainSource],
        default=TerrainSource.FLAT,
        help="heights of the terrain: flat ground, or requests to ground stations (ArduPilot; default: flat)",
    )
    add("--remote-id", action="store_true", help="give each vehicle a Remote ID module (component id 236)")
    add(
        "--transponder", action="store_true", help="give each vehicle an ADS-B transponder (component id 156)"
    )
    add(
        "--ardupilot-version",
        type=version,
        metavar="VERSION",
        help="behave as an older ArduPilot where a program notices it, such as 4.1 (default: 4.6.3)",
    )
    add_bootloader_option(parser)
    add("--seed", type=int, default=1, metavar="N", help="seed of all random numbers (default: 1)")
    add(
        "--speed",
        type=speed,
        default=1.0,
        metavar="N",
        help="simulated seconds per second, or max (default: 1)",
    )
    add("--storage", type=Path, metavar="FOLDER", help="keep files and logs here, in a folder per vehicle")
    add("--for", dest="seconds", type=seconds, metavar="SECONDS", help="end after this simulated time")
    add("--json", action="store_true", help="print events as JSON, one object per line")
    _add_link_options(parser)
    _add_disturbances(parser)


def _add_link_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("links")
    add = group.add_argument
    default = " and ".join(DEFAULT_OUT)
    add("--out", action="append", metavar="URL", help=f"link; may be repeated (default: {default})")
    add("--each", action="store_true", help="one port per vehicle, counting up from the port of the link")
    add("--loss", type=share, default=0.0, metavar="F", help="share of packets lost per direction, 0 to 1")
    add("--latency", type=milliseconds, default=0.0, metavar="MS", help="delay per direction, milliseconds")
    add("--bandwidth", metavar="BYTES", help="bytes per second in each direction, such as 5760 or 64k")
    add(
        "--radio",
        choices=("sik",),
        help="telemetry radios between vehicle and ground, with RADIO_STATUS; sik: 57600 baud, half duplex",
    )
    add_link_options(group, identity=False)


def _add_disturbances(parser: ArgumentParser) -> None:
    add = parser.add_argument_group("disturbances").add_argument
    add(
        "--wind",
        type=wind,
        metavar="SPEED,FROM[,GUSTS]",
        help="m/s, degrees that it comes from, share of gusts (default: 0.1)",
    )
    add(
        "--obstacle",
        action="append",
        type=obstacle,
        default=[],
        metavar="NORTH,EAST,RADIUS[,HEIGHT]",
        help="cylinder on the ground, metres from home; vehicles get a proximity sensor; may be repeated",
    )
    add(
        "--fault",
        action="append",
        default=[],
        metavar="'SECONDS [ID:] FAULT'",
        help="inject a fault at a time; may be repeated",
    )
    add("--script", type=Path, metavar="FILE", help="inject the faults of a file, one per line")


def run(arguments: Namespace) -> int:
    """Run `mav sim`, until Ctrl-C unless `--for` is given."""
    if arguments.bootloader is not None:
        return run_until_signal(simulate_board(arguments))
    return run_until_signal(_simulate(arguments))


async def _simulate(arguments: Namespace) -> int:
    from mavstack.sim.faults import FaultScript
    from mavstack.sim.runner import Runner
    from mavstack.sim.simulation import SITE_BITS, Simulation

    controllers = controller_firmwares(arguments)
    site = randbits(SITE_BITS)  # not derived from the seed: each run simulates a different fleet
    simulation = Simulation(seed=arguments.seed, start=_start_time(), storage=arguments.storage, site=site)
    for each in arguments.obstacle:
        simulation.add_obstacle(each, home=arguments.home)
    if arguments.wind:
        strength, direction, turbulence = arguments.wind
        simulation.world.set_wind(speed=strength, direction=direction, turbulence=turbulence)
    script = FaultScript([*_lines(arguments.script), *arguments.fault])
    printer = EventPrinter(arguments.json)
    vehicles = _fleet(arguments, controllers, simulation)
    for vehicle in vehicles:
        vehicle.listeners.append(printer.event)
    try:
        async with Runner(simulation, speed=arguments.speed, on_link_down=printer.link_down) as runner:
            links = await _connect(runner, vehicles, arguments, speaks_msp=bool(controllers))
            prefix = PREFIX if controllers else ""
            printer.begin(vehicles, [prefix + link.url.redacted for link in links])
            announce_exposure("sim", links)
            async with filming(vehicles, arguments.video):
                await _run(runner, script, printer, arguments.seconds)
    finally:
        simulation.close()
    return 0


def _fleet(
    arguments: Namespace, controllers: list[ControllerFirmware], simulation: Simulation
) -> Sequence[SimulatedVehicle | SimulatedFlightController]:
    """Add the vehicles to the simulation."""
    from mavstack.sim.fleet import Fleet

    firmwares = _firmwares(arguments) if not controllers else ()
    if arguments.ardupilot_version is not None and Firmware.ARDUPILOT not in firmwares:
        raise UsageError("--ardupilot-version needs --firmware ardupilot")
    fleet = Fleet(
        _kinds(VehicleType, arguments.type, "--type"),
        firmwares,
        arguments.count,
        arguments.home,
        arguments.system,
        camera=arguments.camera or arguments.video is not None,
        gimbal=arguments.gimbal,
        rangefinders=arguments.rangefinder,
        terrain=arguments.terrain,
        remote_id=arguments.remote_id,
        transponder=arguments.transponder,
        version=arguments.ardupilot_version,
        controllers=controllers,
    )
    return fleet.add_flight_controllers_to(simulation) if controllers else fleet.add_to(simulation)


def _start_time() -> float:
    from time import time

    return float(int(time()))


async def _connect(
    runner: Runner,
    vehicles: Sequence[SimulatedVehicle | SimulatedFlightController],
    arguments: Namespace,
    *,
    speaks_msp: bool,
) -> list[Link]:
    from mavstack.sim.fleet import link_per_vehicle

    if speaks_msp:
        urls = [
            PREFIX + _impaired(url, arguments)
            for url in transports(arguments.out or [DEFAULT_MSP_OUT], len(vehicles))
        ]
        owners = [vehicle for _ in arguments.out or [DEFAULT_MSP_OUT] for vehicle in vehicles]
        return [await runner.connect(url, [vehicle]) for url, vehicle in zip(urls, owners, strict=True)]
    urls = with_link_options(arguments.out or DEFAULT_OUT, arguments)
    urls = [_impaired(url, arguments) for url in urls]
    if not arguments.each:
        return [await runner.connect(url, vehicles) for url in urls]
    return [
        await runner.connect(own, [vehicle])
        for url in urls
        for own, vehicle in zip(link_per_vehicle(url, len(vehicles)), vehicles, strict=True)
    ]


async def _run(runner: Runner, script: FaultScript, printer: EventPrinter, duration: float | None) -> None:
    from mavstack.cli.watch.link_follower import background_tasks

    script.run_in(runner.simulation, lambda timed: printer.fault(timed, runner.simulation.elapsed))
    async with background_tasks(_read_faults(runner.simulation, printer)):
        await runner.run(duration)


async def _read_faults(simulation: Simulation, printer: EventPrinter) -> None:
    """Inject the faults of the lines on standard input."""
    from mavstack.cli.common.stdin_lines import stdin_lines

    async for line in stdin_lines():
        if text := line.strip():
            _inject(simulation, text, printer)


def _inject(simulation: Simulation, text: str, printer: EventPrinter) -> None:
    from mavstack.sim.faults import FaultError, TimedFault

    try:
        typed = TimedFault.parse(text, simulation.elapsed)
    except FaultError as error:
        echo(f"mav sim: {error}", error=True)
        return
    typed.inject(simulation)
    printer.fault(typed, simulation.elapsed)


def _impaired(url: str, arguments: Namespace) -> str:
    from mavstack.links import parse_url

    wanted = {
        "loss": f"{arguments.loss:g}" if arguments.loss else None,
        "latency": f"{arguments.latency:g}ms" if arguments.latency else None,
        "bandwidth": arguments.bandwidth,
        "radio": arguments.radio,
    }
    options = {name: value for name, value in wanted.items() if value}
    if not options:
        return url
    parsed = parse_url(url)
    options["seed"] = str(arguments.seed)
    return str(replace(parsed, options={**options, **parsed.options}))


def _lines(path: Path | None) -> list[str]:
    return path.read_text().splitlines() if path else []


def _firmwares(arguments: Namespace) -> list[Firmware]:
    """Return the firmwares that speak MAVLink."""
    try:
        return _kinds(Firmware, arguments.firmware, "--firmware")
    except UsageError:
        choices = ", ".join((*Firmware, *ControllerFirmware))
        raise UsageError(f"--firmware {arguments.firmware}: the choices are {choices}") from None


def _kinds(kind: type[Kind], text: str, option: str) -> list[Kind]:
    try:
        return [kind(word.strip().lower()) for word in text.split(",")]
    except ValueError:
        raise UsageError(f"{option} {text}: the choices are {', '.join(kind)}") from None
