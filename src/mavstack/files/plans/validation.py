"""Validation of plans: problems for which every vehicle refuses a plan, or flies it differently.

Only problems for every vehicle are found: the commands that a vehicle supports, and the number of items that
it can hold, it reports itself when the plan is uploaded.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, isnan
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.files.plans.fence import CIRCLES, FENCE_COMMANDS, fence_areas
from mavstack.files.plans.model import CMD, FRAME, PLAN_NAMES
from mavstack.services.frames import GLOBAL_FRAMES, commands_with_location
from mavstack.services.mission import PlanType

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.files.plans.model import PlanFile
    from mavstack.services.mission import MissionItem

#: Commands that need a position; for other commands, an item without a position means the vehicle's position.
_PLACED: Final = frozenset({CMD.NAV_WAYPOINT, CMD.NAV_SPLINE_WAYPOINT})

_FRAMES: Final = frozenset(FRAME)
_WHOLE: Final[Mapping[int, str]] = MappingProxyType(
    {PlanType.MISSION: "a mission", PlanType.FENCE: "a fence", PlanType.RALLY: "the rally points"}
)


@dataclass(frozen=True, slots=True)
class Problem:
    """A problem of an item; `item` is its index in its plan, from 0."""

    kind: int
    item: int
    text: str
    #: The number of the item that ground stations show.
    number: int

    def __str__(self) -> str:
        label = "rally point" if self.kind == PlanType.RALLY else f"{PLAN_NAMES[self.kind]} item"
        return f"{label} {self.number}: {self.text}"


def check(plan: PlanFile) -> list[Problem]:
    """Return the problems of a plan, in the order of its items."""
    found: list[Problem] = []
    for kind in plan.kinds:
        first = plan.first if kind == PlanType.MISSION else 0
        for index, item in enumerate(plan.plan(kind).items):
            wrong = _wrong_with(kind, index, item, plan)
            found += [Problem(kind, index, f"{item.name}: {text}", index + first) for text in wrong]
    for index, text in fence_areas(plan.fence.items).leftovers:
        if plan.fence.items[index].command in FENCE_COMMANDS:
            found.append(Problem(PlanType.FENCE, index, text, index))
    return found


def _wrong_with(kind: int, index: int, item: MissionItem, plan: PlanFile) -> Iterator[str]:
    misplaced = _misplaced(kind, item)
    if misplaced:
        yield misplaced
        return
    if item.command in commands_with_location():
        yield from _wrong_place(kind, item)
    if item.command in CIRCLES and not (isfinite(item.param1) and item.param1 > 0):
        yield f"its radius is {item.param1:g}, which is not a positive number"
    if item.command == CMD.DO_JUMP:
        yield from _wrong_jump(index, item, plan)


def _misplaced(kind: int, item: MissionItem) -> str:
    """Return why an item belongs to another type of plan; empty if it does not."""
    is_fence, is_rally = item.command in FENCE_COMMANDS, item.command == CMD.NAV_RALLY_POINT
    home = PlanType.FENCE if is_fence else PlanType.RALLY if is_rally else PlanType.MISSION
    return "" if home == kind else f"it belongs to {_WHOLE[home]}, not to {_WHOLE[kind]}"


def _wrong_place(kind: int, item: MissionItem) -> Iterator[str]:
    if item.frame == FRAME.MISSION and kind == PlanType.MISSION:
        return
    if item.frame not in _FRAMES:
        yield f"there is no frame {item.frame}"
    if item.frame not in GLOBAL_FRAMES:
        return
    must_be = kind != PlanType.MISSION or item.command in _PLACED
    for label, value, limit in (("latitude", item.param5, 90.0), ("longitude", item.param6, 180.0)):
        if isnan(value):
            if must_be:
                yield f"it has no {label}"
        elif abs(value) > limit:
            yield f"{label} {value:g} is not between {-limit:g} and {limit:g}"
    if not isfinite(item.param7) and (must_be or not isnan(item.param7)):
        yield f"altitude {item.param7:g} is not a number"


def _wrong_jump(index: int, item: MissionItem, plan: PlanFile) -> Iterator[str]:
    count, target = len(plan.mission), item.param1
    if not (isfinite(target) and target == int(target) and 0 <= target < count):
        number = f"{target + plan.first:g}"
        last = count - 1 + plan.first
        yield f"it jumps to item {number}, but the mission's items are {plan.first} to {last}"
    elif target == index:
        yield "it jumps to itself"
