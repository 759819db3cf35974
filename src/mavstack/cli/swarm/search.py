"""`mav swarm search`: a search pattern, divided among the vehicles as ordinary missions."""

from __future__ import annotations

import os
from argparse import ArgumentTypeError
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.connection import run_on_connection
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import finite_number
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.mission.files import save
from mavstack.dialects import common
from mavstack.files.plans import Home, PlanFile
from mavstack.files.plans.model import params_of
from mavstack.geodesy import LocalFrame
from mavstack.swarm.search.division import Searcher
from mavstack.swarm.search.missions import MissionOptions
from mavstack.swarm.search.plans import PATTERNS, Share, pattern_tracks, plan_search
from mavstack.vehicle import Group

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Awaitable, Callable, Mapping, Sequence

    from mavstack.vehicle import Connection, Vehicle

    SelectVehicles = Callable[[Connection, Namespace], Awaitable[Sequence[Vehicle]]]


def add_search_arguments(action: ArgumentParser) -> None:
    """Declare the options of a search."""
    add = action.add_argument
    add("pattern", choices=tuple(PATTERNS), metavar="PATTERN", help=f"one of {', '.join(PATTERNS)}")
    add("--center", type=_place, required=True, metavar="LAT,LON", help="centre of the pattern in degrees")
    numbers: tuple[tuple[str, float | None, str, str], ...] = (
        ("--size", 200.0, "M", "side of the square, or the diameter of a sector search (default: 200)"),
        ("--spacing", 20.0, "M", "metres between tracks (default: 20)"),
        ("--bearing", 0.0, "DEGREES", "direction of the pattern (default: 0)"),
        ("--altitude", 30.0, "M", "height of the first vehicle above home (default: 30)"),
        ("--layer-spacing", 10.0, "M", "metres by which each vehicle is higher (default: 10)"),
        ("--speed", None, "M/S", "ground speed (default: the vehicle's; times are shown for 5)"),
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
        help="write the missions to FILE-SYSTEM.plan, or another format by the suffix",
    )
    add(
        "--dry-run",
        action="store_true",
        help="show the plans and upload nothing; without --url and --count for one vehicle",
    )
    add("--start", action="store_true", help="arm the vehicles, and start the missions")


def search(arguments: Namespace, select: SelectVehicles) -> int:
    """Run `mav swarm search`.

    Args:
        arguments: The parsed arguments.
        select: Returns the vehicles of the swarm, the first one for the lowest layer.
    """
    planned_only = arguments.dry_run or arguments.out is not None
    if arguments.count is not None and not planned_only:
        raise UsageError("--count plans without vehicles: add --dry-run or --out FILE")
    if arguments.start and planned_only:
        raise UsageError("--start uploads the missions: it cannot be used with --dry-run or --out")
    if planned_only and (arguments.count or not (arguments.url or os.environ.get("MAVSTACK_URL"))):
        count = arguments.count or 1
        shares = _plan(arguments, [None] * count)
        return _finish(arguments, dict(zip(range(1, count + 1), shares, strict=True)))

    async def run_search(connection: Connection) -> int:
        vehicles = await select(connection, arguments)
        shares = _plan(arguments, vehicles)
        if not planned_only:
            await _upload(dict(zip(vehicles, shares, strict=True)), start=arguments.start)
        return _finish(arguments, {each.system: share for each, share in zip(vehicles, shares, strict=True)})

    return run_on_connection(arguments, run_search)


def _plan(arguments: Namespace, vehicles: Sequence[Vehicle | None]) -> list[Share]:
    latitude, longitude = arguments.center
    frame = LocalFrame(latitude, longitude, 0.0)
    tracks = pattern_tracks(arguments.pattern, arguments.size, arguments.spacing, arguments.bearing)
    options = MissionOptions(arguments.altitude, arguments.layer_spacing, arguments.speed)
    return plan_search(tracks, [_searcher(arguments, frame, each) for each in vehicles], frame, options)


def _searcher(arguments: Namespace, frame: LocalFrame, vehicle: Vehicle | None) -> Searcher:
    position = None if vehicle is None else vehicle.position
    start = None if position is None else frame.to_local(position.latitude, position.longitude, 0.0)[:2]
    return Searcher(arguments.speed or Searcher().speed, start=start)


async def _upload(shares: Mapping[Vehicle, Share], *, start: bool) -> None:
    async def work(vehicle: Vehicle) -> None:
        items = shares[vehicle].items
        plan = PlanFile.of(items).for_vehicle(0, home_first=vehicle.component.mission.home_first)
        await vehicle.mission.upload(plan)
        if start:
            await vehicle.mission.start(arm=True)

    searching = Group(vehicle for vehicle, share in shares.items() if share.items)
    (await searching.each(work, name="starting the search" if start else "uploading the mission")).check()


def _finish(arguments: Namespace, shares: Mapping[int, Share]) -> int:
    if arguments.out is not None:
        latitude, longitude = arguments.center
        for system, share in shares.items():
            path = Path(arguments.out)
            path = path.with_name(f"{path.stem}-{system}{path.suffix or '.plan'}")
            if share.items:
                save(
                    PlanFile.of(share.items, home=Home(latitude, longitude, 0.0)),
                    str(path),
                    None,
                    force=False,
                )
    if arguments.json:
        echo_json(
            {
                "pattern": arguments.pattern,
                "center": arguments.center,
                "size_m": arguments.size,
                "spacing_m": arguments.spacing,
                "uploaded": not (arguments.dry_run or arguments.out is not None),
                "vehicles": [_as_json(arguments, system, share) for system, share in shares.items()],
            }
        )
    else:
        echo(*(_line(arguments, system, share) for system, share in shares.items()))
    return 0


def _line(arguments: Namespace, system: int, share: Share) -> str:
    if not share.items:
        return f"vehicle {system}: no part of the search"
    minutes = share.length / (arguments.speed or Searcher().speed) / 60.0
    text = f"{len(share.tracks)} legs, {share.length:.0f} m, {minutes:.1f} min at {share.altitude:.0f} m"
    return f"vehicle {system}: {text}"


def _as_json(arguments: Namespace, system: int, share: Share) -> dict[str, Any]:
    return {
        "system": system,
        "altitude_m": share.altitude,
        "length_m": round(share.length, 1),
        "duration_s": round(share.length / (arguments.speed or Searcher().speed), 1),
        "waypoints": [
            [*params_of(item)[4:]] for item in share.items if item.command == common.MavCmd.NAV_WAYPOINT
        ],
        "items": [
            {"command": item.name, "params": [None if isnan(each) else each for each in params_of(item)]}
            for item in share.items
        ],
    }


def _place(text: str) -> tuple[float, float]:
    """Parse LAT,LON, for argparse."""
    try:
        latitude, longitude = map(float, text.split(","))
    except ValueError:
        raise ArgumentTypeError(f"{text!r} is not a place such as 47.3977,8.5456") from None
    if not (abs(latitude) <= 90.0 and abs(longitude) <= 180.0):
        raise ArgumentTypeError(f"{text!r} is not a place on Earth")
    return latitude, longitude


def _count(text: str) -> int:
    if not (text.isascii() and text.isdecimal() and 1 <= int(text) <= 255):
        raise ArgumentTypeError(f"{text!r} is not a number of vehicles from 1 to 255")
    return int(text)
