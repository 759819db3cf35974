"""`mav terrain`: serve the heights that vehicles ask for, and check what a vehicle has."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import DEFAULT_URL, add_vehicle_action, run_on_connection, run_on_vehicle
from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.link_options import add_link_options
from mavstack.cli.common.options import finite_number, seconds
from mavstack.cli.common.output import echo, echo_json
from mavstack.errors import MavstackError
from mavstack.files.elevation import HgtFolder

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.services.terrain import Heights, TerrainState
    from mavstack.vehicle import Connection, Vehicle

EXAMPLES: Final = """\
examples:
  mav terrain serve --hgt ~/.tilecache/SRTM3       # a folder of files such as N47E008.hgt.zip
  mav terrain serve --tiles heights.mbtiles        # of mav map download --terrain
  mav terrain serve --height 488 --for 60          # the same height everywhere, for a minute
  mav terrain check 47.3985 8.5460
  mav terrain check 47.3985 8.5460 --wait --json   # wait until the vehicle has it

ArduPilot asks for terrain while TERRAIN_ENABLE is 1; PX4 does not. Try it: mav sim --terrain request
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "terrain", EXAMPLES)
    action = actions.add("serve", "send vehicles the heights that they ask for, until Ctrl-C", serve)
    source = action.add_mutually_exclusive_group(required=True)
    source.add_argument("--hgt", type=Path, metavar="FOLDER", help="folder of .hgt files, zipped or not")
    source.add_argument("--tiles", type=Path, metavar="FILE", help="heights as tiles in an .mbtiles file")
    source.add_argument("--height", type=finite_number, metavar="METRES", help="one height, above the sea")
    action.add_argument("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")
    action.add_argument("--json", action="store_true", help="print the counts of tiles as JSON at the end")
    action.add_argument(
        "--url",
        action="append",
        metavar="URL",
        help=f"link to vehicles; may be repeated (default: $MAVSTACK_URL or {DEFAULT_URL})",
    )
    add_link_options(action.add_argument_group("links"))
    action = add_vehicle_action(actions, "check", "show whether a vehicle has the terrain of a place", check)
    action.add_argument("latitude", type=finite_number, metavar="LAT", help="degrees")
    action.add_argument("longitude", type=finite_number, metavar="LON", help="degrees")
    action.add_argument("--wait", action="store_true", help="wait until the vehicle has it")


def serve(arguments: Namespace) -> int:
    """Run `mav terrain serve`."""
    heights, described = _heights(arguments)

    async def work(connection: Connection) -> int:
        server = connection.serve_terrain(heights)
        if not arguments.json:
            echo(f"serving {described} on " + ", ".join(link.url.redacted for link in connection.links))
        try:
            await asyncio.wait_for(connection.serve_forever(), arguments.duration)
        except TimeoutError:
            return 0
        finally:
            if arguments.json:
                echo_json({"sent": server.sent, "unknown": server.unknown})
            else:
                echo(f"{server.sent} tiles sent, {server.unknown} not known")
        return 0

    return run_on_connection(arguments, work)


def check(arguments: Namespace) -> int:
    """Run `mav terrain check`."""
    place = arguments.latitude, arguments.longitude

    async def work(vehicle: Vehicle) -> int:
        if arguments.wait:
            await vehicle.terrain.wait_until_loaded(place)
        state = await vehicle.terrain.check(*place)
        if arguments.json:
            echo_json({"system": vehicle.system} | asdict(state))
        else:
            echo(_text(state))
        return 0 if state.is_known else 1

    return run_on_vehicle(arguments, work)


def _heights(arguments: Namespace) -> tuple[Heights, str]:
    """Return the chosen heights, and their name."""
    if arguments.tiles is not None:
        from mavstack.maps.heights import TileHeights

        return TileHeights(arguments.tiles), str(arguments.tiles)
    if arguments.hgt is None:
        height: float = arguments.height
        return lambda latitude, longitude: height, f"{height:g} m"
    try:
        folder = HgtFolder(arguments.hgt)
    except OSError as error:
        raise CommandError(f"cannot open {arguments.hgt}: {error.strerror}") from None
    except MavstackError as error:
        raise CommandError(str(error)) from None
    return folder, f"{len(folder)} files of {arguments.hgt}"


def _text(state: TerrainState) -> str:
    tiles = f"{state.loaded} tiles loaded, {state.pending} pending"
    if state.terrain_height is None or state.current_height is None:
        return f"the vehicle lacks the terrain there; {tiles}"
    above = round(state.current_height, 1) + 0.0  # adding 0.0 turns -0.0 into 0.0
    return f"terrain {state.terrain_height:.1f} m above the sea, vehicle {above:.1f} m above it; {tiles}"
