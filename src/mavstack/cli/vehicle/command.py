"""`mav vehicle`: one thing asked of a vehicle, or of several; the exit code tells whether it was done."""

from __future__ import annotations

import json
from argparse import ArgumentTypeError
from math import isfinite
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_connection_options, run_on_connection
from mavstack.cli.common.options import seconds
from mavstack.cli.common.errors import UsageError
from mavstack.cli.vehicle.flight_progress import height_of, to_altitude, to_home, to_place
from mavstack.cli.vehicle.info import gather_facts, health_facts, page
from mavstack.cli.vehicle.selection import add_selection, carry_out, chosen, several
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable

    from mavstack.vehicle import Connection, Vehicle

EXAMPLES = """\
examples:
  mav vehicle info
  mav vehicle info --json
  mav vehicle health --wait 60
  mav vehicle arm
  mav vehicle arm --all
  mav vehicle takeoff 20
  mav vehicle goto 47.3985 8.5460 30
  mav vehicle orbit 47.3985 8.5460 30 --radius 40 --speed 5
  mav vehicle speed 8
  mav vehicle yaw 90
  mav vehicle hold
  mav vehicle modes
  mav vehicle mode GUIDED
  mav vehicle rtl --no-wait
  mav vehicle land --limit 120
  mav vehicle disarm --force
  mav vehicle home
  mav vehicle home here
  mav vehicle say "survey begins"
  mav vehicle reboot --systems 1,3-5
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "vehicle", EXAMPLES)
    _with_force(_action(actions, "arm", "let the motors run", arm))
    _with_force(_action(actions, "disarm", "stop the motors", disarm))
    taking = _flight(actions, "takeoff", "take off to an altitude, and stay there", takeoff)
    taking.add_argument(
        "altitude", nargs="?", type=_number, default=10.0, metavar="M", help="above home (default: 10)"
    )
    _flight(actions, "land", "land where it is", land)
    _flight(actions, "rtl", "return home, and land there", rtl)
    _action(actions, "hold", "stay where it is; a wing circles", hold)
    going = _with_place(_flight(actions, "goto", "go to a place", goto))
    going.add_argument("--yaw", type=_number, metavar="DEGREES", help="the heading that it takes there")
    going.add_argument("--radius", type=_number, metavar="M", help="of the circle that a wing flies there")
    circling = _with_place(_flight(actions, "orbit", "circle a place", orbit))
    circling.add_argument(
        "--radius",
        type=_number,
        default=20.0,
        metavar="M",
        help="clockwise; negative: the other way",
    )
    circling.add_argument("--speed", type=_number, metavar="M/S", help="along the circle")
    _action(actions, "mode", "enter a flight mode", mode).add_argument("mode", metavar="NAME")
    _asking(actions, "modes", "list its flight modes", modes)
    _action(actions, "speed", "fly so fast over ground", speed).add_argument(
        "speed", type=_number, metavar="M/S"
    )
    _flight(actions, "yaw", "turn to a heading", yaw).add_argument("heading", type=_number, metavar="DEGREES")
    placing = _action(actions, "home", "show where home is, or set it", home)
    placing.add_argument("place", nargs="*", metavar="PLACE", help="here, or LAT LON [ALT above sea]")
    _flight(actions, "reboot", "reboot the autopilot, and wait until it is back", reboot, limited=False)
    _asking(actions, "info", "show what it is and how it is", info)
    looking = _asking(actions, "health", "tell whether it is ready to arm, and why not", health)
    looking.add_argument("--wait", type=seconds, metavar="SECONDS", help="until it is ready, so long at most")
    saying = _action(actions, "say", "tell all who are on the link a text (STATUSTEXT)", say)
    saying.add_argument("text", metavar="TEXT")


def run(arguments: Namespace) -> int:
    """Carry out the action that was chosen."""
    code: int = arguments.run_action(arguments)
    return code


def arm(arguments: Namespace) -> int:
    """`mav vehicle arm`."""

    async def work(vehicle: Vehicle) -> str:
        await vehicle.arm(force=arguments.force)
        return "armed"

    return carry_out(arguments, work)


def disarm(arguments: Namespace) -> int:
    """`mav vehicle disarm`."""

    async def work(vehicle: Vehicle) -> str:
        await vehicle.disarm(force=arguments.force)
        return "disarmed"

    return carry_out(arguments, work)


def takeoff(arguments: Namespace) -> int:
    """`mav vehicle takeoff`."""
    altitude = arguments.altitude

    async def work(vehicle: Vehicle) -> str:
        await vehicle.takeoff(altitude, **_waiting(arguments))
        return _done(arguments, f"is {altitude:g} m above home", f"takes off to {altitude:g} m")

    return carry_out(arguments, work, to_altitude(altitude))


def land(arguments: Namespace) -> int:
    """`mav vehicle land`."""

    async def work(vehicle: Vehicle) -> str:
        await vehicle.land(**_waiting(arguments))
        return _done(arguments, "has landed", "lands")

    return carry_out(arguments, work, height_of)


def rtl(arguments: Namespace) -> int:
    """`mav vehicle rtl`."""

    async def work(vehicle: Vehicle) -> str:
        await vehicle.rtl(**_waiting(arguments))
        return _done(arguments, "is home", "returns home")

    return carry_out(arguments, work, to_home)


def hold(arguments: Namespace) -> int:
    """`mav vehicle hold`."""

    async def work(vehicle: Vehicle) -> str:
        await vehicle.hold()
        return "holds"

    return carry_out(arguments, work)


def goto(arguments: Namespace) -> int:
    """`mav vehicle goto`."""
    latitude, longitude, altitude = arguments.latitude, arguments.longitude, arguments.altitude

    async def work(vehicle: Vehicle) -> str:
        how = _waiting(arguments)
        await vehicle.goto(latitude, longitude, altitude, yaw=arguments.yaw, radius=arguments.radius, **how)
        return _done(arguments, "is there", "goes there")

    return carry_out(arguments, work, to_place(latitude, longitude))


def orbit(arguments: Namespace) -> int:
    """`mav vehicle orbit`."""
    place = arguments.latitude, arguments.longitude, arguments.altitude

    async def work(vehicle: Vehicle) -> str:
        how = _waiting(arguments)
        await vehicle.orbit(*place, radius=arguments.radius, speed=arguments.speed, **how)
        return _done(arguments, "is on the circle", "goes to the circle")

    return carry_out(arguments, work, to_place(*place[:2]))


def mode(arguments: Namespace) -> int:
    """`mav vehicle mode`."""

    async def work(vehicle: Vehicle) -> str:
        name = arguments.mode
        await vehicle.set_mode(int(name) if name.isdecimal() else name)
        return f"is in {vehicle.mode or name}"

    return carry_out(arguments, work)


def modes(arguments: Namespace) -> int:
    """`mav vehicle modes`."""

    async def show(vehicle: Vehicle) -> None:
        found = await vehicle.modes.list()
        rows = [(each.name, each.custom_mode, each.selectable) for each in found]
        if arguments.json:
            keys = ("name", "custom_mode", "selectable")
            listed = [dict(zip(keys, row, strict=True)) for row in rows]
            print(json.dumps({"system": vehicle.system, "mode": vehicle.mode, "modes": listed}))
            return
        if several(arguments):
            print(f"vehicle {vehicle.system}:")
        for name, number, selectable in rows:
            here = "*" if name.lower() == (vehicle.mode or "").lower() else " "
            print(f"{here} {name:{max(len(row[0]) for row in rows)}}  {number}{'' if selectable else '  -'}")

    return _each_in_turn(arguments, show)


def speed(arguments: Namespace) -> int:
    """`mav vehicle speed`."""

    async def work(vehicle: Vehicle) -> str:
        await vehicle.set_speed(arguments.speed)
        return f"flies {arguments.speed:g} m/s"

    return carry_out(arguments, work)


def yaw(arguments: Namespace) -> int:
    """`mav vehicle yaw`."""

    async def work(vehicle: Vehicle) -> str:
        await vehicle.set_yaw(arguments.heading, **_waiting(arguments))
        heading = f"{arguments.heading % 360:g}°"
        return _done(arguments, f"points to {heading}", f"turns to {heading}")

    return carry_out(arguments, work)


def home(arguments: Namespace) -> int:
    """`mav vehicle home`."""
    place = _home_place(arguments.place)

    async def work(vehicle: Vehicle) -> str:
        if place is not None:
            await vehicle.set_home(*place)
        else:
            await vehicle.telemetry.ask_for_home()
        where = vehicle.home
        if where is None:
            if place is None:
                raise CommandError(f"vehicle {vehicle.system} has no home yet")
            return "home is set"
        return f"home is {where.latitude:.7f} {where.longitude:.7f}, {where.altitude:.1f} m above sea"

    return carry_out(arguments, work)


def reboot(arguments: Namespace) -> int:
    """`mav vehicle reboot`."""

    async def work(vehicle: Vehicle) -> str:
        await vehicle.reboot(wait=arguments.wait)
        return _done(arguments, "is back after its reboot", "reboots")

    return carry_out(arguments, work)


def info(arguments: Namespace) -> int:
    """`mav vehicle info`."""

    async def show(vehicle: Vehicle) -> None:
        facts = await gather_facts(vehicle)
        print(*([json.dumps(facts, allow_nan=False)] if arguments.json else page(facts)), sep="\n")

    return _each_in_turn(arguments, show)


def health(arguments: Namespace) -> int:
    """`mav vehicle health`; the exit code tells whether it is ready."""
    ready: list[bool] = []

    async def show(vehicle: Vehicle) -> None:
        if arguments.wait:
            await vehicle.wait_until_ready(timeout=arguments.wait)
            facts = health_facts(vehicle)
        else:
            facts = (await gather_facts(vehicle))["health"]
        ready.append(bool(facts["ready"]))
        if arguments.json:
            print(json.dumps({"system": vehicle.system, **facts}))
            return
        head = {True: "ready to arm", False: "not ready to arm", None: "does not say whether it is ready"}
        print(f"vehicle {vehicle.system}: {head[facts['ready']]}")
        for problem in facts["problems"]:
            print(f"  {problem}")

    return _each_in_turn(arguments, show) or (0 if all(ready) else 1)


def say(arguments: Namespace) -> int:
    """`mav vehicle say`."""
    if not arguments.text.strip():
        raise UsageError("an empty text tells nothing")

    async def work(vehicle: Vehicle) -> str:
        vehicle.connection.send_statustext(arguments.text)
        return "told"

    return carry_out(arguments, work)


def _each_in_turn(arguments: Namespace, show: Callable[[Vehicle], Any]) -> int:
    async def whole(node: Connection) -> int:
        for vehicle in await chosen(node, arguments):
            await show(vehicle)
        return 0

    return run_on_connection(arguments, whole)


def _waiting(arguments: Namespace) -> dict[str, Any]:
    return {"wait": arguments.wait, "timeout": arguments.limit}


def _done(arguments: Namespace, done: str, begun: str) -> str:
    return done if arguments.wait else begun


def _home_place(given: list[str]) -> tuple[float | None, ...] | None:
    """Where home is to be: None to show it, nothing in it for here."""
    if not given:
        return None
    if given == ["here"]:
        return ()
    try:
        place = tuple(map(float, given))
    except ValueError:
        place = ()
    if len(place) not in (2, 3):
        raise UsageError("home is `here`, or LAT LON [ALT] in degrees and metres above sea")
    return place


def _action(actions: Actions, name: str, summary: str, run_it: Callable[[Namespace], int]) -> ArgumentParser:
    parser = actions.add(name, summary, run_it)
    parser.add_argument("--json", action="store_true", help="for programs: an object for each vehicle")
    add_selection(parser)
    add_connection_options(parser)
    return parser


_asking = _action


def _flight(
    actions: Actions,
    name: str,
    summary: str,
    run_it: Callable[[Namespace], int],
    *,
    limited: bool = True,
) -> ArgumentParser:
    """An action that takes a while."""
    parser = _action(actions, name, summary, run_it)
    parser.add_argument(
        "--no-wait", dest="wait", action="store_false", help="leave as soon as the vehicle has accepted it"
    )
    if limited:
        parser.add_argument("--limit", type=seconds, metavar="SECONDS", help="wait no longer than this")
    return parser


def _with_force(parser: ArgumentParser) -> None:
    parser.add_argument("--force", action="store_true", help="whatever the vehicle's own checks say")


def _with_place(parser: ArgumentParser) -> ArgumentParser:
    parser.add_argument("latitude", type=_number, metavar="LAT", help="in degrees")
    parser.add_argument("longitude", type=_number, metavar="LON", help="in degrees")
    parser.add_argument(
        "altitude", nargs="?", type=_number, metavar="M", help="above home (default: as high as it is)"
    )
    return parser


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise ArgumentTypeError(f"{text!r} is not a number")
    return value
