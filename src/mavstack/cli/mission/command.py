"""`mav mission`: upload, download, clear, start, show and convert missions, fences and rally points."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.connection import add_connection_options
from mavstack.cli.common.selection import selected_vehicles
from mavstack.cli.mission.files import convert
from mavstack.cli.mission.search import add_search_arguments, search
from mavstack.cli.mission.show import show
from mavstack.cli.mission.survey import add_survey_arguments, survey
from mavstack.cli.mission.transfer import clear, download, start, upload
from mavstack.files.plans import FORMATS
from mavstack.services.mission import PLAN_TYPES, PlanType

if TYPE_CHECKING:
    from argparse import ArgumentParser

EXAMPLES = """\
examples:
  mav mission upload flight.plan
  mav mission upload flight.waypoints --verify
  mav mission upload flight.plan --systems 1-3
  mav mission upload area.fen --fence
  mav mission download flight.plan
  mav mission download > flight.waypoints
  mav mission download --fence --format fence
  mav mission clear
  mav mission clear --fence --rally
  mav mission clear --all-plans
  mav mission start
  mav mission start --wait
  mav mission show
  mav mission show flight.plan
  mav mission show flight.plan --json
  mav mission convert flight.plan flight.waypoints --mission
  mav mission convert flight.waypoints flight.plan
  mav mission convert flight.plan - --format json
  mav mission survey 47.397,8.545 47.397,8.547 47.399,8.547 --spacing 25 --out survey.plan
  mav mission survey --area field.plan --camera 73.7,53.1 --altitude 60 --dry-run
  mav mission survey 47.397,8.545 47.399,8.546 --corridor 60 --dry-run
  mav mission search square --center 47.3977,8.5456 --spacing 15 --out search.plan
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "mission", EXAMPLES)
    action = actions.add("upload", "replace plans of the vehicle by those of a file", upload)
    action.add_argument("file", metavar="FILE", help="plan file of any known format; - is standard input")
    _add_plan_types(action, "the plans of the file")
    action.add_argument("--verify", action="store_true", help="download the plans again, and compare")
    action.add_argument("--force", action="store_true", help="upload plans in which errors were found")
    add_connection_options(action, fleet=True, changes=True)
    action = actions.add(
        "download", "download plans of the vehicle to a file or to standard output", download
    )
    action.add_argument(
        "file", nargs="?", default="-", metavar="FILE", help="file to write; its suffix selects the format"
    )
    _add_plan_types(action, "all plans that the format can hold", with_all=True)
    _add_format(action)
    add_connection_options(action)
    action = actions.add("clear", "delete plans of the vehicle", clear)
    _add_plan_types(action, "the mission", with_all=True)
    add_connection_options(action, fleet=True, changes=True)
    action = actions.add("start", "arm if needed, and fly the mission", start)
    action.add_argument("--wait", action="store_true", help="wait until the mission is complete")
    add_connection_options(action, fleet=True, changes=True)
    action = actions.add("show", "show the plans of a file or of the vehicle", show)
    action.add_argument("file", nargs="?", metavar="FILE", help="plan file (default: ask the vehicle)")
    _add_plan_types(action, "all plans")
    action.add_argument(
        "--json", action="store_true", help="print JSON, which `upload` and `convert` can read"
    )
    action.add_argument("--no-map", dest="map", action="store_false", help="do not draw a map")
    add_connection_options(action)
    action = actions.add("convert", "convert a plan file to another format", convert)
    action.add_argument("input", metavar="IN", help="plan file of any known format; - is standard input")
    action.add_argument(
        "output", metavar="OUT", help="file to write; its suffix selects the format; - is standard output"
    )
    _add_plan_types(action, "the plans of the file")
    _add_format(action)
    _add_planners(actions)


def _add_planners(actions: Actions) -> None:
    action = actions.add(
        "survey",
        "cover an area or a corridor by tracks, as missions",
        partial(survey, select=selected_vehicles),
    )
    action.add_argument("--json", action="store_true", help="print JSON")
    add_survey_arguments(action)
    add_connection_options(action, fleet=True, changes=True)
    action = actions.add(
        "search",
        "search around a point by a pattern, as missions",
        partial(search, select=selected_vehicles, numbered=False),
    )
    action.add_argument("--json", action="store_true", help="print JSON")
    add_search_arguments(action)
    add_connection_options(action, fleet=True, changes=True)


def _add_plan_types(parser: ArgumentParser, default: str, *, with_all: bool = False) -> None:
    group = parser.add_argument_group("plans", f"default: {default}; several may be selected")
    for name, plan_type, text in (
        ("--mission", PlanType.MISSION, "the mission"),
        ("--fence", PlanType.FENCE, "the geofence"),
        ("--rally", PlanType.RALLY, "the rally points"),
    ):
        options: dict[str, Any] = {"action": "append_const", "dest": "plan_types", "const": plan_type}
        group.add_argument(name, **options, help=text)
    if with_all:
        group.add_argument(
            "--all-plans", dest="plan_types", action="store_const", const=PLAN_TYPES, help="all three"
        )


def _add_format(parser: ArgumentParser) -> None:
    formats = "; ".join(f"{name}: {each.summary}" for name, each in FORMATS.items())
    parser.add_argument("--format", choices=tuple(FORMATS), help=formats)
    parser.add_argument(
        "--force", action="store_true", help="write the file though a part of the plan is lost"
    )
