"""ArduPilot's plan files, transferred by MAVLink FTP: `@MISSION/mission.dat` and others.

    header   magic u16 · plan type u16 · options u16 · first item u16 · number of items u16
    item     the fields of MISSION_ITEM_INT, 38 bytes as in an untruncated packet

With option 1 an upload replaces only the items from `first item` on; else it is the whole plan.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from struct import Struct
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import BROADCAST
from mavstack.services.mission.item import MissionItem
from mavstack.services.mission.plan import MAX_ITEMS, Plan, PlanType

if TYPE_CHECKING:
    from collections.abc import Mapping

PLAN_FILES: Mapping[int, str] = {
    PlanType.MISSION: "@MISSION/mission.dat",
    PlanType.FENCE: "@MISSION/fence.dat",
    PlanType.RALLY: "@MISSION/rally.dat",
}
MAGIC = 0x763D
ITEM_SIZE = 38
PARTIAL = 1
_HEADER = Struct("<HHHHH")


@dataclass(frozen=True, slots=True)
class PlanFile:
    """The content of a plan file: a plan, or with `partial` the items from `first` on."""

    plan: Plan
    first: int = 0
    partial: bool = False

    def applied_to(self, held: Plan) -> Plan | None:
        """Return the plan that results from an upload over `held`; None if items would be missing."""
        if not self.partial:
            return self.plan if self.first == 0 else None
        if self.first > len(held):
            return None
        end = self.first + len(self.plan)
        return Plan(held.type, (*held.items[: self.first], *self.plan.items, *held.items[end:]))


def pack_plan(plan: Plan, *, current: int = -1) -> bytes:
    """Encode a plan file; `current` is the current item."""
    if len(plan) > MAX_ITEMS:
        raise InvalidArgumentError(f"a plan file holds at most {MAX_ITEMS} items, got {len(plan)}")
    items = (
        item.to_int(BROADCAST, seq, plan.type, current=seq == current).to_payload().ljust(ITEM_SIZE, b"\0")
        for seq, item in enumerate(plan.items)
    )
    return _HEADER.pack(MAGIC, plan.type, 0, 0, len(plan)) + b"".join(items)


def unpack_plan(data: bytes) -> PlanFile | None:
    """Decode a plan file; None if it is damaged, truncated, or has an unwritten item."""
    if len(data) < _HEADER.size:
        return None
    magic, plan_type, options, first, count = _HEADER.unpack_from(data)
    if magic != MAGIC or len(data) != _HEADER.size + count * ITEM_SIZE:
        return None
    pieces = [data[at : at + ITEM_SIZE] for at in range(_HEADER.size, len(data), ITEM_SIZE)]
    if not all(map(any, pieces)):
        return None
    items = (MissionItem.read(common.MissionItemInt.from_payload(piece)) for piece in pieces)
    plan = Plan.of((replace(item, current=False) for item in items), plan_type)
    return PlanFile(plan, first, bool(options & PARTIAL))
