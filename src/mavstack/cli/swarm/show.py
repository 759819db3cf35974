"""`mav swarm show`: check a show, fly it, write the files of its vehicles, or upload them."""

from __future__ import annotations

from argparse import ArgumentTypeError
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mavstack.atomic_file import write_file_atomically
from mavstack.bounded_file import read_file_bounded
from mavstack.cli.common.options import finite_number
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.mission.planned import place
from mavstack.swarm.separation import Margins
from mavstack.swarm.shows.check import ShowLimits, check_show
from mavstack.swarm.shows.reading import MAX_FILE, parse_show
from mavstack.swarm.shows.skyb import write_skyb
from mavstack.swarm.transitions import Limits

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.swarm.shows.check import ShowReport
    from mavstack.swarm.shows.show import Show


def add_show_arguments(action: ArgumentParser) -> None:
    """Declare the options of a show."""
    add = action.add_argument
    add("file", metavar="FILE", help="a .skyc file, or a ZIP archive of CSV files")
    add("--check", action="store_true", help="only check separation, speeds and accelerations")
    add("--skyb", metavar="FOLDER", help="only write the .skyb file of each vehicle")
    add("--upload", action="store_true", help="upload the .skyb files instead of flying by setpoints")
    add("--origin", type=place, metavar="LAT,LON", help="place of the show's origin (default: the vehicles')")
    add(
        "--orientation",
        type=finite_number,
        default=0.0,
        metavar="DEGREES",
        help="direction of the show's x axis (default: 0, north)",
    )
    add(
        "--position-error",
        type=_error,
        default=Margins().position,
        metavar="M",
        help="standard deviation of positions, for the distance that is kept (default: 0.5; with RTK 0.02)",
    )
    for name, default, text in (
        ("--speed", 5.0, "largest speed over ground in m/s (default: 5)"),
        ("--climb", 2.0, "largest vertical speed in m/s (default: 2)"),
        ("--acceleration", 2.0, "largest acceleration in m/s² (default: 2)"),
    ):
        add(name, type=finite_number, default=default, metavar="N", help=text)


def read_show(arguments: Namespace) -> Show:
    """Return the show of the arguments."""
    path = Path(arguments.file)
    return parse_show(read_file_bounded(path, MAX_FILE + 1), path.name)


def margins(arguments: Namespace) -> Margins:
    """Return the margins of the arguments."""
    return Margins(position=arguments.position_error, speed=arguments.speed)


def limits(arguments: Namespace) -> Limits:
    """Return the limits of the arguments."""
    return Limits(arguments.speed, arguments.climb, arguments.acceleration)


def check(arguments: Namespace, show: Show) -> int:
    """Print the check of a show; return 1 if it passes a limit."""
    report = check_show(show, ShowLimits(margins(arguments).planned_distance, limits(arguments)))
    if arguments.json:
        echo_json(_as_json(show, report))
    else:
        apart = f"{report.separation:.2f} m" if isfinite(report.separation) else "one vehicle"
        echo(
            f"{show.name}: {len(show.vehicles)} vehicles, {report.duration:.1f} s",
            f"smallest separation  {apart}",
            f"largest speeds       {report.speed:.1f} m/s over ground, {report.climb:.1f} m/s vertical",
            f"largest acceleration {report.acceleration:.1f} m/s²",
            *(f"problem: {each}" for each in report.problems),
        )
    return 1 if report.problems else 0


def write_files(arguments: Namespace, show: Show) -> int:
    """Write the `.skyb` file of each vehicle."""
    folder = Path(arguments.skyb)
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for number, vehicle in enumerate(show.vehicles, start=1):
        path = folder / f"{number:04d}.skyb"
        write_file_atomically(path, write_skyb(vehicle))
        files.append(str(path))
    if arguments.json:
        echo_json({"files": files})
    else:
        echo(f"{len(files)} files in {folder}")
    return 0


def _as_json(show: Show, report: ShowReport) -> dict[str, Any]:
    return {
        "name": show.name,
        "vehicles": len(show.vehicles),
        "duration_s": round(report.duration, 3),
        "separation_m": round(report.separation, 3) if isfinite(report.separation) else None,
        "speed_m_s": round(report.speed, 3),
        "climb_m_s": round(report.climb, 3),
        "acceleration_m_s2": round(report.acceleration, 3),
        "problems": list(report.problems),
        "ok": not report.problems,
    }


def _error(text: str) -> float:
    value = finite_number(text)
    if value < 0.0:
        raise ArgumentTypeError(f"{text!r} is not a standard deviation: at least 0 m")
    return value
