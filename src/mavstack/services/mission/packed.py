"""ArduPilot's files of plans, read and written by MAVLink FTP: `@MISSION/mission.dat` and its like.

    header   magic u16 · plan type u16 · options u16 · first item u16 · number of items u16
    item     the fields of MISSION_ITEM_INT, 38 bytes as they are in an untruncated packet

With option 1 an upload replaces only the items from `first item` on; else it is the whole plan.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from struct import Struct
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import LocalProtocolError
from mavstack.services.addressing import EVERYBODY
from mavstack.services.mission.item import MissionItem
from mavstack.services.mission.plan import MOST_ITEMS, Plan, PlanType

if TYPE_CHECKING:
    from collections.abc import Mapping

PLAN_FILES: Mapping[int, str] = {
    PlanType.MISSION: "@MISSION/mission.dat",
    PlanType.FENCE: "@MISSION/fence.dat",
    PlanType.RALLY: "@MISSION/rally.dat",
}
MAGIC = 0x763D
ITEM_SIZE = 38
KEEP_THE_REST = 1
_HEADER = Struct("<HHHHH")


@dataclass(frozen=True, slots=True)
class PlanFile:
    """What such a file holds: a plan, or with `keep_the_rest` the items from `first` on."""

    plan: Plan
    first: int = 0
    keep_the_rest: bool = False

    def applied_to(self, held: Plan) -> Plan | None:
        """What is to be in the place of a plan; None if there would be a gap in it."""
        if not self.keep_the_rest:
            return self.plan if self.first == 0 else None
        if self.first > len(held):
            return None
        end = self.first + len(self.plan)
        return Plan(held.type, (*held.items[: self.first], *self.plan.items, *held.items[end:]))


def pack_plan(plan: Plan, *, current: int = -1) -> bytes:
    """The file of a plan; `current` is the item the vehicle is at."""
    if len(plan) > MOST_ITEMS:
        raise LocalProtocolError(f"a file of a plan holds {MOST_ITEMS} items at most")
    items = (
        item.to_int(EVERYBODY, seq, plan.type, current=seq == current).to_payload().ljust(ITEM_SIZE, b"\0")
        for seq, item in enumerate(plan.items)
    )
    return _HEADER.pack(MAGIC, plan.type, 0, 0, len(plan)) + b"".join(items)


def unpack_plan(data: bytes) -> PlanFile | None:
    """Read a file of a plan; None if it is damaged, cut off, or has an item that nobody wrote."""
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
    return PlanFile(plan, first, bool(options & KEEP_THE_REST))
