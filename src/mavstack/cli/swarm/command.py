"""`mav swarm`: several vehicles that fly as one.

An action takes all vehicles that are heard, or those of `--systems`, and says which. It returns when the
swarm has arrived, and lets each vehicle hold then. `mav swarm stop` works from any terminal: it sets the
mode in which a vehicle holds, which ends the setpoints of every other program.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_vehicle_action, run_on_connection
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.live_line import LiveLine
from mavstack.cli.common.options import finite_number, system_id
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.selection import selected_vehicles
from mavstack.cli.mission.search import add_search_arguments, search
from mavstack.cli.swarm.progress import heights_text, progress_text
from mavstack.cli.swarm.show import add_show_arguments, check, limits, margins, read_show, write_files
from mavstack.swarm.formations import FORMATIONS, Formation, default_spacing
from mavstack.vehicle.following.follow import LEVELS
from mavstack.vehicle.swarm import Swarm, SwarmOptions
from mavstack.vehicle.swarm.launch import DEFAULT_ALTITUDE, take_off
from mavstack.vehicle.swarm.skybrush import upload_show

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Awaitable, Callable

    from mavstack.vehicle import Connection, Group, Vehicle

EXAMPLES: Final = """\
examples:
  mav swarm takeoff 20 --layer-spacing 10                 # arm, and climb to 20, 30, 40 m …
  mav swarm formation wedge --spacing 12
  mav swarm formation line --spacing 12 --lead 2 --takeoff --altitude 20
  mav swarm formation text --text T --altitude 60
  mav swarm move 100 0 5                                  # north, east, up in metres
  mav swarm goto 47.3985 8.5460 60
  mav swarm rotate 90
  mav swarm follow 4 column --spacing 10 --for 20
  mav swarm search parallel --center 47.3977,8.5456 --size 200 --spacing 20 --count 3 --dry-run
  mav swarm search square --center 47.3977,8.5456 --spacing 15 --altitude 30
  mav swarm show show.skyc --check                        # separation, speeds, accelerations
  mav swarm show show.skyc --orientation 30               # fly it by setpoints, after a takeoff
  mav swarm land --systems 1,3-4
  mav swarm stop
  mav swarm list                                          # the formations
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "swarm", EXAMPLES)
    action = _add(actions, "takeoff", "arm, and take off to one height or to layers", takeoff)
    action.add_argument(
        "altitude",
        nargs="?",
        type=finite_number,
        default=DEFAULT_ALTITUDE,
        metavar="ALTITUDE",
        help=f"metres above home (default: {DEFAULT_ALTITUDE:g})",
    )
    action.add_argument(
        "--layer-spacing",
        type=finite_number,
        default=0.0,
        metavar="M",
        help="metres by which each vehicle is higher than the one before (default: 0)",
    )
    action = _add(actions, "formation", "fly into a formation around the leader", formation)
    _add_formation(action)
    action.add_argument(
        "--course", type=finite_number, metavar="DEGREES", help="direction of the formation (default: north)"
    )
    action.add_argument(
        "--altitude",
        type=finite_number,
        metavar="M",
        help="height of the leader in metres above home (default: its own; after a takeoff 10)",
    )
    action.add_argument(
        "--takeoff", action="store_true", help="arm the vehicles on the ground, and take off first"
    )
    _add_moves(actions)
    action = _add(actions, "follow", "follow a vehicle that another program flies", follow)
    action.add_argument("leader", type=system_id, metavar="ID", help="system id of the vehicle to follow")
    _add_formation(action, default="wedge")
    action.add_argument(
        "--for", dest="seconds", type=finite_number, metavar="SECONDS", help="end after this time"
    )
    action.add_argument(
        "--level",
        choices=LEVELS,
        default=LEVELS[0],
        help="setpoints need Wi-Fi; by radio each firmware's own Follow mode flies (default: setpoints)",
    )
    action = _add(actions, "search", "divide a search pattern among the vehicles, as missions", find)
    add_search_arguments(action)
    action = _add(actions, "show", "check a show, fly it, or upload it", perform)
    add_show_arguments(action)
    _add(actions, "land", "land all vehicles where they are", land)
    _add(actions, "stop", "let all vehicles hold where they are", stop)
    action = actions.add("list", "list the formations", show)
    action.add_argument("--json", action="store_true", help="print JSON")


def _add_moves(actions: Actions) -> None:
    action = _add(actions, "move", "move all vehicles by the same way", move)
    for name, text in (("north", "metres north"), ("east", "metres east"), ("up", "metres up (default: 0)")):
        action.add_argument(
            name, type=finite_number, nargs="?" if name == "up" else None, default=0.0, help=text
        )
    action = _add(actions, "goto", "move all vehicles so that the leader arrives at a place", goto)
    for name, text in (
        ("latitude", "degrees"),
        ("longitude", "degrees"),
        ("altitude", "metres above the leader's home"),
    ):
        action.add_argument(name, type=finite_number, nargs="?" if name == "altitude" else None, help=text)
    action = _add(actions, "rotate", "turn the formation around the leader", rotate)
    action.add_argument("degrees", type=finite_number, help="degrees, clockwise if positive")


def _add(actions: Actions, name: str, summary: str, run_action: Callable[[Namespace], int]) -> ArgumentParser:
    action = add_vehicle_action(actions, name, summary, run_action, fleet=True, changes=True)
    action.add_argument(
        "--lead", type=system_id, metavar="ID", help="system id of the leader (default: the lowest)"
    )
    return action


def _add_formation(action: ArgumentParser, default: str | None = None) -> None:
    add = action.add_argument
    add(
        "shape",
        nargs="?" if default else None,
        default=default,
        choices=tuple(FORMATIONS),
        metavar="SHAPE",
        help=f"one of {', '.join(FORMATIONS)}",
    )
    add(
        "--spacing",
        type=finite_number,
        metavar="M",
        help="metres between neighbours (default: what errors of positions need)",
    )
    add(
        "--angle",
        type=finite_number,
        default=45.0,
        metavar="DEGREES",
        help="angle of a wedge's or echelon's arms to the course (default: 45)",
    )
    add(
        "--rotation",
        type=finite_number,
        default=0.0,
        metavar="DEGREES",
        help="turn the whole shape clockwise (default: 0)",
    )
    add("--layers", type=int, default=1, metavar="N", help="number of height layers (default: 1)")
    add(
        "--layer-spacing",
        type=finite_number,
        default=0.0,
        metavar="M",
        help="metres between layers (default: 0)",
    )
    add("--text", default="", metavar="TEXT", help="the text of the shape text")


def show(arguments: Namespace) -> int:
    """Run `mav swarm list`."""
    if arguments.json:
        echo_json(dict(FORMATIONS))
    else:
        echo(*(f"{name:<10} {text}" for name, text in FORMATIONS.items()))
    return 0


def takeoff(arguments: Namespace) -> int:
    """Run `mav swarm takeoff`."""

    async def work(group: Group) -> str:
        (await take_off(group, arguments.altitude, layer_spacing=arguments.layer_spacing)).check()
        return "in the air"

    return _run_on_group(arguments, work)


def formation(arguments: Namespace) -> int:
    """Run `mav swarm formation`."""

    async def prepare(group: Group) -> None:
        if arguments.takeoff:
            altitude = DEFAULT_ALTITUDE if arguments.altitude is None else arguments.altitude
            (await take_off(group, altitude)).check()

    async def work(swarm: Swarm) -> str:
        shape = _shape(arguments)
        await swarm.formation(shape, course=arguments.course, altitude=arguments.altitude)
        return f"in formation {arguments.shape}"

    return _run_on_swarm(arguments, work, prepare)


def move(arguments: Namespace) -> int:
    """Run `mav swarm move`."""

    async def work(swarm: Swarm) -> str:
        await swarm.move(arguments.north, arguments.east, arguments.up)
        return "arrived"

    return _run_on_swarm(arguments, work)


def goto(arguments: Namespace) -> int:
    """Run `mav swarm goto`."""

    async def work(swarm: Swarm) -> str:
        await swarm.goto(arguments.latitude, arguments.longitude, arguments.altitude)
        return "arrived"

    return _run_on_swarm(arguments, work)


def rotate(arguments: Namespace) -> int:
    """Run `mav swarm rotate`."""

    async def work(swarm: Swarm) -> str:
        await swarm.rotate(arguments.degrees)
        return "turned"

    return _run_on_swarm(arguments, work)


def follow(arguments: Namespace) -> int:
    """Run `mav swarm follow`."""
    from mavstack.vehicle import Group

    async def run_follow(connection: Connection) -> int:
        leader = await connection.wait_for_vehicle(arguments.leader, timeout=arguments.timeout)
        vehicles = [each for each in await _vehicles(connection, arguments) if each is not leader]
        _announce(arguments, vehicles)
        group = Group(vehicles)
        await group.follow(leader, _shape(arguments), duration=arguments.seconds, level=arguments.level)
        _report(arguments, vehicles, "following ended", None)
        return 0

    return run_on_connection(arguments, run_follow)


def find(arguments: Namespace) -> int:
    """Run `mav swarm search`."""
    return search(arguments, _vehicles, numbered=True)


def perform(arguments: Namespace) -> int:
    """Run `mav swarm show`."""
    performance = read_show(arguments)
    if arguments.check:
        return check(arguments, performance)
    if arguments.skyb is not None:
        return write_files(arguments, performance)
    if arguments.upload:

        async def upload(group: Group) -> str:
            (await upload_show(group, performance)).check()
            return "uploaded"

        return _run_on_group(arguments, upload)

    async def work(swarm: Swarm) -> str:
        await swarm.show(performance, origin=arguments.origin, orientation=arguments.orientation)
        return f"performed {performance.name}"

    return _run_on_swarm(arguments, work, options=SwarmOptions(margins(arguments), limits(arguments)))


def land(arguments: Namespace) -> int:
    """Run `mav swarm land`."""

    async def work(group: Group) -> str:
        (await group.land()).check()
        return "landed"

    return _run_on_group(arguments, work)


def stop(arguments: Namespace) -> int:
    """Run `mav swarm stop`; a vehicle that is not armed stays as it is."""
    from mavstack.vehicle import Group

    async def work(group: Group) -> str:
        moving = Group(vehicle for vehicle in group if vehicle.armed is not False)
        (await moving.hold()).check()
        return "stopped"

    return _run_on_group(arguments, work)


def _shape(arguments: Namespace) -> Formation:
    """Return the formation of the arguments; without `--spacing`, with the one that any transition needs."""
    spacing = arguments.spacing
    if spacing is None:
        spacing = default_spacing(arguments.shape, SwarmOptions().margins.planned_distance)
    return Formation(
        arguments.shape,
        spacing=spacing,
        angle=arguments.angle,
        rotation=arguments.rotation,
        layers=arguments.layers,
        layer_spacing=arguments.layer_spacing,
        text=arguments.text,
    )


def _run_on_swarm(
    arguments: Namespace,
    work: Callable[[Swarm], Awaitable[str]],
    prepare: Callable[[Group], Awaitable[None]] | None = None,
    options: SwarmOptions | None = None,
) -> int:
    from mavstack.vehicle import Group

    async def run_swarm(connection: Connection) -> int:
        vehicles = await _vehicles(connection, arguments)
        _announce(arguments, vehicles)
        if prepare is not None:
            async with LiveLine(lambda: heights_text("takeoff", vehicles)):
                await prepare(Group(vehicles))
        async with Swarm(vehicles, options) as swarm:
            async with LiveLine(lambda: progress_text(arguments.action, swarm)):
                text = await work(swarm)
            separation = swarm.smallest_separation
        _report(arguments, vehicles, text, separation)
        return 0

    return run_on_connection(arguments, run_swarm)


def _run_on_group(arguments: Namespace, work: Callable[[Group], Awaitable[str]]) -> int:
    from mavstack.vehicle import Group

    async def run_group(connection: Connection) -> int:
        vehicles = await _vehicles(connection, arguments)
        _announce(arguments, vehicles)
        async with LiveLine(lambda: heights_text(arguments.action, vehicles)):
            text = await work(Group(vehicles))
        _report(arguments, vehicles, text, None)
        return 0

    return run_on_connection(arguments, run_group)


async def _vehicles(connection: Connection, arguments: Namespace) -> list[Vehicle]:
    """Return the vehicles of the swarm, the leader first."""
    if arguments.system is None and arguments.systems is None:
        arguments.all = True
    found = sorted(await selected_vehicles(connection, arguments), key=lambda vehicle: vehicle.system)
    leads = [vehicle for vehicle in found if vehicle.system == arguments.lead]
    if arguments.lead is not None and not leads:
        known = ", ".join(str(vehicle.system) for vehicle in found)
        raise UsageError(f"--lead {arguments.lead} is not one of the vehicles {known}")
    return leads + [vehicle for vehicle in found if vehicle not in leads]


def _announce(arguments: Namespace, vehicles: list[Vehicle]) -> None:
    if not arguments.json:
        names = ", ".join(str(vehicle.system) for vehicle in vehicles)
        echo(f"swarm of {names}; {vehicles[0].system} leads")


def _report(arguments: Namespace, vehicles: list[Vehicle], text: str, separation: float | None) -> None:
    known = separation is not None and math.isfinite(separation)
    if arguments.json:
        outcome = {"action": arguments.action, "ok": True, "text": text}
        outcome["systems"] = [vehicle.system for vehicle in vehicles]
        outcome["smallest_separation_m"] = round(separation, 2) if known and separation is not None else None
        echo_json(outcome)
        return
    echo(f"{text}; the smallest separation was {separation:.1f} m" if known else text)
