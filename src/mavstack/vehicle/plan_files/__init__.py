"""Plans in files: QGroundControl's, ArduPilot's ground stations', and our own, read, checked and written."""

from mavstack.vehicle.plan_files.areas import Areas, Circle, Polygon, ReturnPoint, areas_of, items_of
from mavstack.vehicle.plan_files.checking import Problem, check
from mavstack.vehicle.plan_files.model import Home, PlanFile, Settings
from mavstack.vehicle.plan_files.own import item_json, plan_json
from mavstack.vehicle.plan_files.registry import (
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
