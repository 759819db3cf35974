"""`mav mission`: the mission, fence and rally points of a vehicle, given, got, cleared, flown, shown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_connection_options
from mavstack.cli.mission.files import convert
from mavstack.cli.mission.show import show
from mavstack.cli.mission.transfer import clear, download, start, upload
from mavstack.files.plans import FORMATS
from mavstack.services.mission import PLAN_TYPES, PlanType

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

EXAMPLES = """\
examples:
  mav mission upload flight.plan
  mav mission upload flight.waypoints --verify
  mav mission upload area.fen --fence
  mav mission download flight.plan
  mav mission download > flight.waypoints
  mav mission download --fence --format fence
  mav mission clear
  mav mission clear --fence --rally
  mav mission clear --all
  mav mission start
  mav mission start --wait
  mav mission show
  mav mission show flight.plan
  mav mission show flight.plan --json
  mav mission convert flight.plan flight.waypoints --mission
  mav mission convert flight.waypoints flight.plan
  mav mission convert flight.plan - --format json
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "mission", EXAMPLES)
    giving = actions.add("upload", "give the vehicle what a file holds, in place of what it has", upload)
    giving.add_argument("file", metavar="FILE", help="of any format that can be read; - is standard input")
    _with_kinds(giving, "what the file holds")
    giving.add_argument("--verify", action="store_true", help="read it back, and compare")
    giving.add_argument("--force", action="store_true", help="send it, though something is wrong with it")
    add_connection_options(giving)
    getting = actions.add("download", "get what the vehicle has, into a file or to standard output", download)
    getting.add_argument("file", nargs="?", default="-", metavar="FILE", help="its suffix says the format")
    _with_kinds(getting, "all that the format can hold", all_too=True)
    _with_format(getting)
    add_connection_options(getting)
    clearing = actions.add("clear", "let the vehicle forget its plans", clear)
    _with_kinds(clearing, "the mission", all_too=True)
    add_connection_options(clearing)
    starting = actions.add("start", "arm if need be, and fly the mission", start)
    starting.add_argument("--wait", action="store_true", help="until it has been flown")
    add_connection_options(starting)
    showing = actions.add("show", "show what a file holds, or what the vehicle has", show)
    showing.add_argument("file", nargs="?", metavar="FILE", help="without it the vehicle is asked")
    _with_kinds(showing, "all")
    showing.add_argument("--json", action="store_true", help="for programs; `upload` and `convert` read it")
    showing.add_argument("--no-map", dest="map", action="store_false", help="without the sketch")
    add_connection_options(showing)
    converting = actions.add("convert", "write what a file holds in another format", convert)
    converting.add_argument("input", metavar="IN", help="of any format that can be read; - is standard input")
    converting.add_argument("output", metavar="OUT", help="its suffix says the format; - is standard output")
    _with_kinds(converting, "what the file holds")
    _with_format(converting)


def run(arguments: Namespace) -> int:
    """Carry out the action that was chosen."""
    code: int = arguments.run_action(arguments)
    return code


def _with_kinds(parser: ArgumentParser, default: str, *, all_too: bool = False) -> None:
    group = parser.add_argument_group("which plans", f"by default {default}; several may be named")
    for name, kind, what in (
        ("--mission", PlanType.MISSION, "what it is to fly"),
        ("--fence", PlanType.FENCE, "where it must stay"),
        ("--rally", PlanType.RALLY, "where it may land when it returns"),
    ):
        options: dict[str, Any] = {"action": "append_const", "dest": "kinds", "const": kind}
        group.add_argument(name, **options, help=what)
    if all_too:
        group.add_argument("--all", dest="kinds", action="store_const", const=PLAN_TYPES, help="all three")


def _with_format(parser: ArgumentParser) -> None:
    formats = "; ".join(f"{name}: {each.summary}" for name, each in FORMATS.items())
    parser.add_argument("--format", choices=tuple(FORMATS), help=formats)
    parser.add_argument("--force", action="store_true", help="write it, though something of it is lost")
