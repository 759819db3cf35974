"""Plans: what a vehicle is to fly (mission), where it must stay (fence), where it may go (rally).

The three are independent of each other: each is transferred, stored, cleared and identified alone. A plan's
id is made by the vehicle and is opaque; 0 means that there is no plan, or that the vehicle makes no ids.
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

#: The kinds of plan that there are; `PlanType.ALL` stands for all of them, in clearing only.
PLAN_TYPES = (PlanType.MISSION, PlanType.FENCE, PlanType.RALLY)
#: MISSION_COUNT has 16 bits.
MOST_ITEMS = 0xFFFF


@dataclass(frozen=True, slots=True)
class Plan:
    """The items of one type, in order; `plan_id` is what the vehicle calls this very plan."""

    type: int
    items: tuple[MissionItem, ...] = ()
    plan_id: int = field(default=0, compare=False)

    @classmethod
    def of(cls, items: Iterable[MissionItem], plan_type: int = PlanType.MISSION) -> Self:
        """A plan of these items."""
        return cls(plan_type, tuple(items))

    def __len__(self) -> int:
        return len(self.items)

    def with_id(self, plan_id: int) -> Self:
        """The same plan under the vehicle's id."""
        return replace(self, plan_id=plan_id)

    def checksum(self) -> int:
        """An id that follows from the items: never 0 unless there are none."""
        if not self.items:
            return 0
        value = crc32(bytes([self.type & 0xFF]))
        for item in self.items:
            value = crc32(item.to_bytes(), value)
        return value or 1


def name_of(plan_type: int) -> str:
    """A plan type in a text for people: "the mission"."""
    names = {
        PlanType.MISSION: "the mission",
        PlanType.FENCE: "the fence",
        PlanType.RALLY: "the rally points",
        PlanType.ALL: "all plans",
    }
    return names.get(plan_type, f"plan type {plan_type}")  # type: ignore[call-overload, no-any-return]


class PlanStore:
    """Where a vehicle keeps its plans; override `put` to write them down, give `plans` to begin with some."""

    def __init__(self, plans: Mapping[int, Plan] | None = None) -> None:
        self._plans: dict[int, Plan] = dict(plans or {})

    def get(self, plan_type: int) -> Plan:
        """The plan of a type; an empty one if there is none."""
        return self._plans.get(plan_type) or Plan(plan_type)

    def put(self, plan: Plan) -> None:
        """Put a plan in the place of the one of its type."""
        self._plans[plan.type] = plan
