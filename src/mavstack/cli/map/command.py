"""`mav map`: maps for places without network, which the station serves."""

from __future__ import annotations

import asyncio
import sys
from contextlib import nullcontext
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.confirmation import add_yes_option, is_confirmed
from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.common.text import duration_text, printable, size_text
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.errors import InvalidArgumentError
from mavstack.maps import (
    Area,
    DownloadEstimate,
    MapArchive,
    MapError,
    Pace,
    TileServer,
    download_area,
    estimate_download,
)
from mavstack.maps.archive import ENCODINGS
from mavstack.maps.folder import default_folder, list_maps, map_path, remove_map
from mavstack.maps.tiles import read_zooms

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from mavstack.maps import MapFacts

EXAMPLES: Final = """\
examples:
  mav map download 'https://tiles.example.org/{z}/{x}/{y}.png' --area 47.39,8.53,47.41,8.56 --name field
  mav map download 'https://tiles.example.org/{z}/{x}/{y}.png' --around 47.3977,8.5456,2000 --dry-run
  mav map download 'https://tiles.example.org/dem/{z}/{x}/{y}.png' --around 47.4,8.55,5000 --terrain terrarium
  mav map list
  mav map info field --json
  mav map remove field

mav web serves the maps; a file is an MBTiles archive, which other programs read too. Ctrl-C ends a download,
and the same command continues it. Read the terms of a tile server before you download from it.
"""
DEFAULT_ZOOM: Final = "10-16"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "map", EXAMPLES, _checked)
    action = actions.add(
        "download", "download the tiles of an area into one file, and continue a download", download
    )
    action.add_argument("server", metavar="URL", help="address of the tiles, with {z}, {x} and {y}")
    area = action.add_mutually_exclusive_group(required=True)
    area.add_argument(
        "--area", metavar="S,W,N,E", help="sides of the area: south, west, north, east in degrees"
    )
    area.add_argument("--around", metavar="LAT,LON,METRES", help="a place, and the metres to each side of it")
    action.add_argument(
        "--zoom", default=DEFAULT_ZOOM, metavar="A-B", help=f"zoom levels (default: {DEFAULT_ZOOM})"
    )
    target = action.add_mutually_exclusive_group()
    target.add_argument("--name", help="name of the map for the station (default: map, or terrain)")
    target.add_argument("--file", type=Path, metavar="FILE", help="the file, instead of a name: FILE.mbtiles")
    action.add_argument(
        "--terrain", choices=ENCODINGS, default="", help="the pictures are heights in this encoding"
    )
    action.add_argument("--attribution", default="", metavar="TEXT", help="credit of the owner of the tiles")
    action.add_argument(
        "--rate", type=float, default=10.0, metavar="N", help="requests per second (default: 10)"
    )
    action.add_argument(
        "--connections", type=int, default=2, metavar="N", help="requests at a time (default: 2)"
    )
    action.add_argument("--dry-run", action="store_true", help="only estimate tiles, bytes and time")
    add_yes_option(action)
    _add_common(action)
    action = actions.add("list", "list the maps of the station", list_all)
    _add_common(action)
    action = actions.add("info", "show a map", info)
    action.add_argument("map", metavar="NAME|FILE", help="name of a map, or a file")
    _add_common(action)
    action = actions.add("remove", "remove a map", remove)
    action.add_argument("map", metavar="NAME", help="name of a map")
    add_yes_option(action)
    _add_common(action, has_json=False)


def _checked(run: Callable[[Namespace], int], arguments: Namespace) -> int:
    try:
        return run(arguments)
    except InvalidArgumentError as error:
        raise UsageError(str(error)) from None


def download(arguments: Namespace) -> int:
    """Run `mav map download`."""
    server = TileServer(arguments.server)
    area, zooms = _area(arguments), read_zooms(arguments.zoom)
    pace = Pace(rate=arguments.rate, connections=arguments.connections)
    path = arguments.file if arguments.file is not None else map_path(_folder(arguments), _name(arguments))
    if not server.terms.allowed:
        raise MapError(f"downloading tiles from {server.host} failed: {server.terms.text}")
    echo(f"mav map: {server.terms.text}", error=True)
    with _existing(path) as archive:
        estimate = asyncio.run(estimate_download(server, area, zooms, archive, rate=pace.rate))
    if arguments.dry_run or not arguments.json:
        _show_estimate(arguments, estimate, server)
    if arguments.dry_run:
        return 0
    if sys.stdin is not None and sys.stdin.isatty() and estimate.missing:
        question = f"download {estimate.missing:,} tiles from {server.host}"
        if not is_confirmed(arguments, question, "download", refused="nothing was downloaded"):
            return 1

    async def work() -> int:
        options = {
            "attribution": arguments.attribution or server.terms.attribution,
            "encoding": arguments.terrain,
        }
        with (
            MapArchive.create(path, **options) as archive,
            TransferProgress(path.stem, in_bytes=False) as progress,
        ):
            result = await download_area(archive, server, area, zooms, pace=pace, progress=progress)
            facts = archive.facts()
        if arguments.json:
            echo_json({"file": str(path), **asdict(result), "map": _values(facts)})
        else:
            absent = f", {result.absent:,} are not on the server" if result.absent else ""
            added = f"{result.added:,} tiles added ({size_text(result.bytes)})"
            echo(f"{path}: {added}, {result.present:,} were there{absent}")
        return 0

    return run_until_signal(work())


def list_all(arguments: Namespace) -> int:
    """Run `mav map list`."""
    folder = _folder(arguments)
    maps = list_maps(folder)
    if arguments.json:
        echo_json([_values(facts) for facts in maps])
        return 0
    if not maps:
        echo(f"{folder} has no maps; mav map download makes one")
    echo(*align_columns([_row(facts) for facts in maps]))
    return 0


def info(arguments: Namespace) -> int:
    """Run `mav map info`."""
    given = Path(arguments.map)
    path = given if given.suffix == ".mbtiles" else map_path(_folder(arguments), arguments.map)
    with MapArchive.open(path) as archive:
        facts = archive.facts()
    if arguments.json:
        echo_json(_values(facts))
        return 0
    area = facts.area
    rows = [
        ("file", str(path)),
        ("content", _content(facts)),
        ("zoom", f"{facts.min_zoom} to {facts.max_zoom}"),
        (
            "area",
            "not known" if area is None else f"{area.south:g},{area.west:g},{area.north:g},{area.east:g}",
        ),
        ("tiles", f"{facts.tiles:,}"),
        ("size", size_text(facts.size)),
        ("attribution", printable(facts.attribution)),
    ]
    echo(*align_columns([(name, text) for name, text in rows if text]))
    return 0


def remove(arguments: Namespace) -> int:
    """Run `mav map remove`."""
    path = map_path(_folder(arguments), arguments.map)
    if not path.is_file():
        raise CommandError(f"removing {path} failed: there is no such file")
    if not is_confirmed(arguments, f"remove {path}", "remove a map", refused="nothing was removed"):
        return 1
    remove_map(path)
    return 0


def _add_common(parser: ArgumentParser, *, has_json: bool = True) -> None:
    parser.add_argument("--folder", type=Path, metavar="FOLDER", help="the maps (default: those of mav web)")
    if has_json:
        parser.add_argument("--json", action="store_true", help="print JSON")


def _folder(arguments: Namespace) -> Path:
    folder: Path = default_folder() if arguments.folder is None else arguments.folder
    return folder


def _name(arguments: Namespace) -> str:
    return arguments.name or ("terrain" if arguments.terrain else "map")


def _area(arguments: Namespace) -> Area:
    if arguments.area is not None:
        return Area.parse(arguments.area)
    try:
        latitude, longitude, metres = map(float, arguments.around.split(","))
    except ValueError:
        raise UsageError(f"--around is LAT,LON,METRES, got {arguments.around[:60]!r}") from None
    return Area.around(latitude, longitude, metres)


def _existing(path: Path) -> AbstractContextManager[MapArchive | None]:
    return MapArchive.open(path) if path.is_file() else nullcontext()


def _show_estimate(arguments: Namespace, estimate: DownloadEstimate, server: TileServer) -> None:
    if arguments.json:
        echo_json({"server": server.host, "terms": server.terms.text, **asdict(estimate)})
        return
    there = estimate.tiles - estimate.missing
    known = f", {there:,} of them are in the file" if there else ""
    size, time = size_text(estimate.bytes), duration_text(estimate.seconds)
    echo(
        f"{estimate.tiles:,} tiles{known}; about {size} to download in {time} at {arguments.rate:g} a second"
    )


def _content(facts: MapFacts) -> str:
    if facts.encoding:
        return f"heights ({facts.encoding})"
    return "vectors" if facts.format == "pbf" else f"pictures ({facts.format or 'none yet'})"


def _row(facts: MapFacts) -> tuple[str, ...]:
    zooms = f"zoom {facts.min_zoom}-{facts.max_zoom}"
    return printable(facts.name), _content(facts), zooms, f"{facts.tiles:,} tiles", size_text(facts.size)


def _values(facts: MapFacts) -> dict[str, Any]:
    return asdict(replace(facts, attribution=printable(facts.attribution)))
