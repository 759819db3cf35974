"""Missions that a planner makes for one vehicle or several: shown, written to files, uploaded, started."""

from __future__ import annotations

import os
from argparse import ArgumentTypeError
from dataclasses import dataclass
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.connection import run_on_connection
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import finite_number
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.selection import selects_several
from mavstack.cli.mission.files import save
from mavstack.dialects import common
from mavstack.files.plans import Home, PlanFile
from mavstack.files.plans.model import params_of
from mavstack.swarm.search.division import Searcher
from mavstack.swarm.search.missions import MissionOptions
from mavstack.vehicle import Group
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Awaitable, Callable, Collection, Mapping, Sequence

    from mavstack.geodesy import LocalFrame
    from mavstack.swarm.search.plans import Share
    from mavstack.vehicle import Connection, Vehicle

    SelectVehicles = Callable[[Connection, Namespace], Awaitable[Collection[Vehicle]]]
    #: Makes the plans for vehicles; None stands for a vehicle that is not known.
    MakePlan = Callable[[Sequence[Vehicle | None]], "Planned"]


@dataclass(frozen=True, slots=True)
class Planned:
    """The missions of a plan.

    Attributes:
        shares: The share of each vehicle.
        frame: The frame of their legs; its origin is the home in files.
        values: The measures of the plan, the first members of its JSON.
        searchers: The vehicles, whose speeds the durations are for.
    """

    shares: Sequence[Share]
    frame: LocalFrame
    values: Mapping[str, Any]
    searchers: Sequence[Searcher]


def add_plan_options(action: ArgumentParser) -> None:
    """Declare the options of missions that a planner makes."""
    add = action.add_argument
    numbers: tuple[tuple[str, float | None, str, str], ...] = (
        ("--bearing", None, "DEGREES", "direction of the tracks (default: the plan's own)"),
        ("--altitude", 30.0, "M", "height of the first vehicle above home (default: 30)"),
        ("--layer-spacing", 10.0, "M", "metres by which each vehicle is higher (default: 10)"),
        ("--start-delay", 0.0, "S", "seconds by which each vehicle starts later (default: 0)"),
        (
            "--speed",
            None,
            "M/S",
            "ground speed (default: the vehicle's; times are those of its type)",
        ),
    )
    for name, default, metavar, text in numbers:
        add(name, type=finite_number, default=default, metavar=metavar, help=text)
    add(
        "--count",
        type=_count,
        metavar="N",
        help="plan for N vehicles without a connection; needs --dry-run or --out",
    )
    add(
        "--out",
        metavar="FILE",
        help="write the mission to FILE, those of several vehicles to FILE-SYSTEM; the suffix is the format",
    )
    add(
        "--dry-run",
        action="store_true",
        help="show the plans and upload nothing; without --url, --count and a choice of vehicles for one",
    )
    add("--start", action="store_true", help="arm the vehicles, and start the missions")


def run_plan(arguments: Namespace, make: MakePlan, select: SelectVehicles, *, numbered: bool) -> int:
    """Make a plan, and show, write or upload it.

    Args:
        arguments: The parsed arguments.
        make: Makes the plan.
        select: Returns the vehicles, the first one for the lowest layer.
        numbered: True: the file of a single vehicle has its number too.
    """
    planned_only = arguments.dry_run or arguments.out is not None
    chosen = arguments.system is not None or selects_several(arguments)
    if arguments.count is not None and not planned_only:
        raise UsageError("--count plans without vehicles: add --dry-run or --out FILE")
    if arguments.count is not None and chosen:
        raise UsageError(
            "--count cannot be used with --system, --systems or --all: it plans without vehicles"
        )
    if arguments.start and planned_only:
        raise UsageError("--start uploads the missions: it cannot be used with --dry-run or --out")
    named = chosen or arguments.url or os.environ.get("MAVSTACK_URL")
    if planned_only and (arguments.count or not named):
        count = arguments.count or 1
        plan = make([None] * count)
        return _finish(arguments, plan, range(1, count + 1), numbered=numbered)

    async def run(connection: Connection) -> int:
        vehicles = tuple(await select(connection, arguments))
        plan = make(vehicles)
        if not planned_only:
            await _upload(dict(zip(vehicles, plan.shares, strict=True)), start=arguments.start)
        return _finish(arguments, plan, [each.system for each in vehicles], numbered=numbered)

    return run_on_connection(arguments, run)


def searcher_of(arguments: Namespace, frame: LocalFrame, vehicle: Vehicle | None) -> Searcher:
    """Return the position and speed of a vehicle, for the planner."""
    position = None if vehicle is None else vehicle.position
    start = None if position is None else frame.to_local(position.latitude, position.longitude, 0.0)[:2]
    kind = VehicleType.OTHER if vehicle is None else vehicle.vehicle_type
    return Searcher(arguments.speed or kind.typical_speed, start=start)


def mission_options(arguments: Namespace) -> MissionOptions:
    """Return the heights, the speed and the delays of the arguments."""
    return MissionOptions(
        arguments.altitude, arguments.layer_spacing, arguments.speed, start_delay=arguments.start_delay
    )


def place(text: str) -> tuple[float, float]:
    """Parse LAT,LON, for argparse."""
    try:
        latitude, longitude = map(float, text.split(","))
    except ValueError:
        raise ArgumentTypeError(f"{text!r} is not a place such as 47.3977,8.5456") from None
    if not (abs(latitude) <= 90.0 and abs(longitude) <= 180.0):
        raise ArgumentTypeError(f"{text!r} is not a place on Earth")
    return latitude, longitude


async def _upload(shares: Mapping[Vehicle, Share], *, start: bool) -> None:
    async def work(vehicle: Vehicle) -> None:
        items = shares[vehicle].items
        plan = PlanFile.of(items).for_vehicle(0, home_first=vehicle.component.mission.home_first)
        await vehicle.mission.upload(plan)
        if start:
            await vehicle.mission.start(arm=True)

    flying = Group(vehicle for vehicle, share in shares.items() if share.items)
    (await flying.each(work, name="starting the mission" if start else "uploading the mission")).check()


def _finish(arguments: Namespace, plan: Planned, systems: Sequence[int], *, numbered: bool) -> int:
    found = list(zip(systems, plan.shares, plan.searchers, strict=True))
    if arguments.out is not None:
        home = Home(plan.frame.latitude, plan.frame.longitude, 0.0)
        for system, share, _ in found:
            path = Path(arguments.out)
            if numbered or len(found) > 1:
                path = path.with_name(f"{path.stem}-{system}{path.suffix or '.plan'}")
            if share.items:
                save(PlanFile.of(share.items, home=home), str(path), None, force=False)
    if arguments.json:
        uploaded = not (arguments.dry_run or arguments.out is not None)
        vehicles = [_as_json(*each) for each in found]
        echo_json({**plan.values, "uploaded": uploaded, "vehicles": vehicles})
    else:
        echo(*(_line(*each) for each in found))
    return 0


def _line(system: int, share: Share, searcher: Searcher) -> str:
    if not share.items:
        return f"vehicle {system}: no part of the plan"
    minutes = share.way / searcher.speed / 60.0
    legs = "1 leg" if len(share.tracks) == 1 else f"{len(share.tracks)} legs"
    text = f"{legs}, {share.length:.0f} m, {minutes:.1f} min at {share.altitude:.0f} m"
    return f"vehicle {system}: {text}"


def _as_json(system: int, share: Share, searcher: Searcher) -> dict[str, Any]:
    return {
        "system": system,
        "altitude_m": share.altitude,
        "length_m": round(share.length, 1),
        "duration_s": round(share.way / searcher.speed, 1),
        "waypoints": [
            [*params_of(item)[4:]] for item in share.items if item.command == common.MavCmd.NAV_WAYPOINT
        ],
        "items": [
            {"command": item.name, "params": [None if isnan(each) else each for each in params_of(item)]}
            for item in share.items
        ],
    }


def _count(text: str) -> int:
    if not (text.isascii() and text.isdecimal() and 1 <= int(text) <= 255):
        raise ArgumentTypeError(f"{text!r} is not a number of vehicles from 1 to 255")
    return int(text)
