"""Plan files of QGroundControl, Mission Planner, MAVProxy and Mavstack: read, validated and written."""

from mavstack.files.plans.fence import Circle, FenceAreas, Polygon, ReturnPoint, fence_areas, fence_items
from mavstack.files.plans.mavstack_json import item_json, plan_json
from mavstack.files.plans.model import Home, PlanFile, Settings
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
from mavstack.files.plans.validation import Problem, check

__all__ = [
    "FORMATS",
    "Circle",
    "FenceAreas",
    "Format",
    "Home",
    "PlanFile",
    "Polygon",
    "Problem",
    "ReturnPoint",
    "Settings",
    "Written",
    "check",
    "fence_areas",
    "fence_items",
    "format_of",
    "format_plan",
    "item_json",
    "parse_plan",
    "plan_json",
    "read_plan",
    "write_plan",
]
