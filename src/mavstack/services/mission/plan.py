"""Plans: missions (what to fly), fences (where to stay) and rally points (where to return to).

The three are independent: each is transferred, stored, cleared and identified separately. The vehicle makes a
plan's id, which is opaque; 0 means that there is no plan, or that the vehicle makes no ids.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING
from zlib import crc32

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import Self

    from mavstack.services.mission.item import MissionItem

PlanType = common.MavMissionType

#: The types of plans; `PlanType.ALL` stands for all of them, for clearing only.
PLAN_TYPES = (PlanType.MISSION, PlanType.FENCE, PlanType.RALLY)
#: MISSION_COUNT has 16 bits.
MAX_ITEMS = 0xFFFF


@dataclass(frozen=True, slots=True)
class Plan:
    """A mission, a fence or a set of rally points.

    Attributes:
        type: The MAV_MISSION_TYPE.
        items: The items, in order.
        plan_id: The vehicle's id of the plan; 0 if it has none.
    """

    type: int
    items: tuple[MissionItem, ...] = ()
    plan_id: int = field(default=0, compare=False)

    @classmethod
    def of(cls, items: Iterable[MissionItem], plan_type: int = PlanType.MISSION) -> Self:
        """Return a plan of these items."""
        return cls(plan_type, tuple(items))

    def __len__(self) -> int:
        return len(self.items)

    def with_id(self, plan_id: int) -> Self:
        """Return a copy with the vehicle's id."""
        return replace(self, plan_id=plan_id)

    def checksum(self) -> int:
        """Return an id that follows from the items; 0 only for an empty plan."""
        if not self.items:
            return 0
        value = crc32(bytes([self.type & 0xFF]))
        for item in self.items:
            value = crc32(item.to_bytes(), value)
        return value or 1


def name_of(plan_type: int) -> str:
    """Return the name of a plan type: "the mission"."""
    names = {
        PlanType.MISSION: "the mission",
        PlanType.FENCE: "the fence",
        PlanType.RALLY: "the rally points",
        PlanType.ALL: "all plans",
    }
    return names.get(plan_type, f"plan type {plan_type}")  # type: ignore[call-overload, no-any-return]


class PlanStore:
    """The storage of a vehicle's plans; override `put` to make them persistent."""

    def __init__(self, plans: Mapping[int, Plan] | None = None) -> None:
        self._plans: dict[int, Plan] = dict(plans or {})

    def get(self, plan_type: int) -> Plan:
        """Return the plan of a type; an empty one if there is none."""
        return self._plans.get(plan_type) or Plan(plan_type)

    def put(self, plan: Plan) -> None:
        """Replace the plan of the same type."""
        self._plans[plan.type] = plan
