"""`mav sim`: simulated vehicles on links of one's own, for any ground station, library or script to fly.

What the vehicles say and do is told in a line each; a line that is typed is a fault, injected at once (see
`mavstack.sim.faults`).
"""

from __future__ import annotations

import asyncio
import json
import sys
from argparse import ArgumentTypeError
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeVar

from mavstack.cli.common.options import seconds, system_id
from mavstack.cli.common.errors import UsageError
from mavstack.errors import MavstackError
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Sequence

    from mavstack.links import Link
    from mavstack.sim.faults import FaultScript, TimedFault
    from mavstack.sim.runner import Runner
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle

Kind = TypeVar("Kind", VehicleType, Firmware)

EXAMPLES: Final = """\
examples:
  mav sim                                     an ArduPilot copter for any ground station on this machine
  mav sim --type plane --firmware px4         a PX4 plane
  mav sim --type copter,rover --count 10      ten vehicles, copters and rovers in turn, on one port
  mav sim --count 3 --each --out tcpin://0.0.0.0:5760       each on a port of its own: 5760, 5761, 5762
  mav sim --loss 0.1 --latency 200            over a bad radio
  mav sim --home 51.4934,-0.0098,20,90 --wind 6,270,0.2     at Greenwich, in a gusty west wind
  mav sim --fault "30 gps off" --fault "60 battery sag 3"   with things going wrong
  mav sim --speed 10                          ten times as fast
  mav sim --storage flights                   its logs and files stay in a folder

Fly it from another terminal:
  mavproxy.py --master=udpin:0.0.0.0:14550
  mav watch udpin://0.0.0.0:14550

While it runs, type a fault and Enter: gps off, gps on, compass 90, motor 1 off, battery 15, link off, reboot;
with a system id before it, "2: gps off", for one vehicle alone.
"""

#: Where ground stations listen, and where MAVSDK's programs do.
DEFAULT_OUT: Final = ("udpout://127.0.0.1:14550", "udpout://127.0.0.1:14540")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    names, firmwares = ", ".join(VehicleType), ", ".join(Firmware)
    add = parser.add_argument
    add("--type", default="copter", metavar="TYPE", help=f"{names}; several, in turn: copter,plane")
    add("--firmware", default="ardupilot", metavar="NAME", help=f"{firmwares}; several, in turn")
    add("--count", type=_count, default=1, metavar="N", help="how many (default: 1)")
    add(
        "--home",
        type=_home,
        default=DEFAULT_HOME,
        metavar="LAT,LON,ALT,HDG",
        help="where the first one stands",
    )
    add("--system", type=system_id, default=1, metavar="ID", help="system id of the first one (default: 1)")
    add("--out", action="append", metavar="URL", help=f"a link (default: {' and '.join(DEFAULT_OUT)})")
    add("--each", action="store_true", help="a port for each vehicle, counting up from each link's")
    add("--loss", type=_share, default=0.0, metavar="F", help="share of packets lost on each way, 0 to 1")
    add("--latency", type=_milliseconds, default=0.0, metavar="MS", help="delay on each way, milliseconds")
    add("--bandwidth", metavar="BYTES", help="what each way carries in a second, such as 5760 or 64k")
    add("--wind", type=_wind, metavar="SPEED,FROM[,GUSTS]", help="m/s, degrees it comes from, share of gusts")
    add("--seed", type=int, default=1, metavar="N", help="of everything random (default: 1)")
    add(
        "--speed",
        type=_speed,
        default=1.0,
        metavar="N",
        help="simulated seconds in a second; max: all it can",
    )
    add("--fault", action="append", default=[], metavar="'SECONDS [ID:] FAULT'", help="what goes wrong when")
    add("--script", type=Path, metavar="FILE", help="a file of such lines")
    add("--storage", type=Path, metavar="FOLDER", help="keep files and logs there, a folder a vehicle")
    add("--for", dest="seconds", type=seconds, metavar="SECONDS", help="end after so many simulated seconds")
    add("--json", action="store_true", help="what happens as JSON, an object a line")


def run(arguments: Namespace) -> int:
    """Simulate until Ctrl-C."""
    return asyncio.run(_simulate(arguments))


async def _simulate(arguments: Namespace) -> int:
    from mavstack.sim.faults import FaultScript
    from mavstack.sim.fleet import Fleet
    from mavstack.sim.runner import Runner
    from mavstack.sim.simulation import Simulation

    simulation = Simulation(seed=arguments.seed, start=_today(), storage=arguments.storage)
    types = _kinds(VehicleType, arguments.type, "--type")
    firmwares = _kinds(Firmware, arguments.firmware, "--firmware")
    fleet = Fleet(types, firmwares, arguments.count, arguments.home, arguments.system)
    if arguments.wind:
        speed, direction, turbulence = arguments.wind
        simulation.world.set_wind(speed=speed, direction=direction, turbulence=turbulence)
    script = FaultScript([*_lines(arguments.script), *arguments.fault])
    teller = EventPrinter(arguments.json)
    vehicles = fleet.add_to(simulation)
    for vehicle in vehicles:
        vehicle.listeners.append(teller.tell)
    try:
        async with Runner(simulation, speed=arguments.speed, on_link_down=teller.link_down) as runner:
            links = await _connect(runner, vehicles, arguments)
            teller.begin(vehicles, links)
            await _run(runner, script, teller, arguments.seconds)
    finally:
        simulation.close()
    return 0


def _today() -> float:
    from time import time

    return float(int(time()))


async def _connect(runner: Runner, vehicles: Sequence[SimulatedVehicle], arguments: Namespace) -> list[Link]:
    from mavstack.sim.fleet import link_per_vehicle

    urls = [_impaired(url, arguments) for url in arguments.out or DEFAULT_OUT]
    if not arguments.each:
        return [await runner.connect(url, vehicles) for url in urls]
    return [
        await runner.connect(own, [vehicle])
        for url in urls
        for own, vehicle in zip(link_per_vehicle(url, len(vehicles)), vehicles, strict=True)
    ]


async def _run(runner: Runner, script: FaultScript, teller: EventPrinter, limit: float | None) -> None:
    from mavstack.cli.watch.follower import beside

    script.run_in(runner.simulation, lambda timed: teller.fault(timed, runner.simulation.elapsed))
    async with beside(_read_faults(runner.simulation, teller)):
        await runner.run(limit)


async def _read_faults(simulation: Simulation, teller: EventPrinter) -> None:
    """Inject what is typed."""
    from mavstack.cli.common.stdin_lines import stdin_lines

    async for line in stdin_lines():
        if text := line.strip():
            _inject(simulation, text, teller)


def _inject(simulation: Simulation, text: str, teller: EventPrinter) -> None:
    from mavstack.sim.faults import FaultError, TimedFault

    try:
        typed = TimedFault.parse(text, simulation.elapsed)
    except FaultError as error:
        print(f"mav sim: {error}", file=sys.stderr)
        return
    typed.inject(simulation)
    teller.fault(typed, simulation.elapsed)


class EventPrinter:
    """Prints what happens, a line each."""

    def __init__(self, as_json: bool) -> None:
        self._json = as_json
        self._began = 0.0

    def begin(self, vehicles: Sequence[SimulatedVehicle], links: Sequence[Link]) -> None:
        """Say who is there, and where."""
        self._began = vehicles[0].now
        if self._json:
            self._print(
                "ready",
                vehicles=[
                    {"system": each.address.system, "type": each.vehicle_type, "firmware": each.firmware}
                    for each in vehicles
                ],
                links=[str(link.url) for link in links],
            )
            return
        for vehicle in vehicles:
            print(f"system {vehicle.address.system}: {vehicle.firmware} {vehicle.vehicle_type}")
        shown = [str(link.url) for link in links]
        print("on " + (", ".join(shown) if len(shown) <= 6 else f"{shown[0]} … {shown[-1]}"))
        print("type a fault (gps off, battery 15, link off, reboot …), or Ctrl-C to end", flush=True)

    def tell(self, vehicle: SimulatedVehicle, kind: str, text: str) -> None:
        """A vehicle said or did something."""
        system, seconds_in = vehicle.address.system, vehicle.now - self._began
        if self._json:
            self._print(kind, time=round(seconds_in, 2), system=system, text=text)
        else:
            print(f"{seconds_in:8.1f}  {system:3}  {text}", flush=True)

    def fault(self, injected: TimedFault, elapsed: float) -> None:
        """A fault was injected."""
        if self._json:
            fields = {"system": injected.system, "text": injected.fault.text}
            self._print("fault", time=round(elapsed, 2), **fields)
        else:
            whom = injected.system or "all"
            print(f"{elapsed:8.1f}  {whom:3}  FAULT {injected.fault.text}", flush=True)

    def link_down(self, link: Link, reason: str) -> None:
        """A link has no connection."""
        print(f"mav sim: {link.url}: {reason}", file=sys.stderr)

    def _print(self, event: str, **fields: object) -> None:
        print(json.dumps({"event": event, **fields}), flush=True)


def _impaired(url: str, arguments: Namespace) -> str:
    from mavstack.links import parse_url

    wanted = {
        "loss": f"{arguments.loss:g}" if arguments.loss else None,
        "latency": f"{arguments.latency:g}ms" if arguments.latency else None,
        "bandwidth": arguments.bandwidth,
    }
    options = {name: value for name, value in wanted.items() if value}
    if not options:
        return url
    parsed = parse_url(url)
    options["seed"] = str(arguments.seed)
    return str(replace(parsed, options={**options, **parsed.options}))


def _lines(path: Path | None) -> list[str]:
    return path.read_text().splitlines() if path else []


def _kinds(kind: type[Kind], text: str, option: str) -> list[Kind]:
    try:
        return [kind(word.strip().lower()) for word in text.split(",")]
    except ValueError:
        raise UsageError(f"{option} {text}: it is one of {', '.join(kind)}") from None


def _count(text: str) -> int:
    if not (text.isdecimal() and 1 <= int(text) <= 255):
        raise ArgumentTypeError(f"{text!r} is not a number of vehicles, 1 to 255")
    return int(text)


def _home(text: str) -> Home:
    try:
        return Home.parse(text)
    except MavstackError as error:
        raise ArgumentTypeError(str(error)) from None


def _share(text: str) -> float:
    return _number(text, 0.0, 1.0, "a share from 0 to 1")


def _milliseconds(text: str) -> float:
    return _number(text, 0.0, 60_000.0, "a delay of 0 to 60000 ms")


def _speed(text: str) -> float:
    return inf if text == "max" else _number(text, 0.01, 1000.0, "a speed of 0.01 to 1000, or max")


def _wind(text: str) -> tuple[float, float, float]:
    what = "a wind as SPEED,FROM[,GUSTS], such as 5,270,0.2"
    parts = text.split(",")
    if not 2 <= len(parts) <= 3:
        raise ArgumentTypeError(f"{text!r} is not {what}")
    speed, direction, gusts = (_number(part, -360.0, 360.0, what) for part in (*parts, "0.1")[:3])
    return speed, direction, gusts


def _number(text: str, least: float, most: float, what: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = inf
    if not least <= value <= most:
        raise ArgumentTypeError(f"{text!r} is not {what}")
    return value
