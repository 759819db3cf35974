"""Plans in files: QGroundControl's, ArduPilot's ground stations', and our own, read, checked and written."""

from mavstack.files.plans.areas import Areas, Circle, Polygon, ReturnPoint, areas_of, items_of
from mavstack.files.plans.checking import Problem, check
from mavstack.files.plans.model import Home, PlanFile, Settings
from mavstack.files.plans.own import item_json, plan_json
from mavstack.files.plans.registry import (
    FORMATS,
    Format,
    Written,
    format_of,
    format_plan,
    parse_plan,
    read_plan,
    write_plan,
)

__all__ = [
    "FORMATS",
    "Areas",
    "Circle",
    "Format",
    "Home",
    "PlanFile",
    "Polygon",
    "Problem",
    "ReturnPoint",
    "Settings",
    "Written",
    "areas_of",
    "check",
    "format_of",
    "format_plan",
    "item_json",
    "items_of",
    "parse_plan",
    "plan_json",
    "read_plan",
    "write_plan",
]
