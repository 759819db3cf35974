"""Validation of uploaded plans: each item as it arrives, then the whole, by the rules of the firmware."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission import PlanType
from mavstack.sim.autopilot.fence.plan import check_fence_item, check_fence_plan
from mavstack.sim.autopilot.rally import check_rally_item

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem, Plan
    from mavstack.sim.autopilot.mission.rules import MissionRules


def validate_item(rules: MissionRules, kind: int, item: MissionItem) -> int:
    """Validate an item of any plan: MAV_MISSION_RESULT."""
    if kind == PlanType.MISSION:
        return rules.check(item)
    firmware = rules.vehicle.firmware
    return check_fence_item(item) if kind == PlanType.FENCE else check_rally_item(item, firmware)


def validate_plan(rules: MissionRules, plan: Plan, *, flying: bool) -> int:
    """Validate a whole plan: MAV_MISSION_RESULT."""
    if plan.type == PlanType.MISSION:
        return rules.may_replace(flying=flying, empty=not plan.items)
    return check_fence_plan(plan) if plan.type == PlanType.FENCE else common.MavMissionResult.ACCEPTED
