"""The order in which the items of a mission are flown, with its jumps.

A NAV item ends a leg; the DO and CONDITION items before it belong to that leg. A jump is no item of a leg: it
moves the search for the next item, and is counted when a leg is taken through it. A loop of jumps alone, or
of DO items alone, ends the mission.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.services.mission import MissionItem

_CMD = common.MavCmd
FOREVER = -1
MAX_JUMPS = 64
MAX_ACTIONS = 255


@dataclass(frozen=True, slots=True)
class Leg:
    """The DO and CONDITION items of a leg, and its NAV item; None after the last one."""

    actions: tuple[int, ...]
    navigation: int | None
    #: The sequence number at which the search for the next leg begins.
    then: int


class Route:
    """The items of a mission, and the counts of the jumps taken."""

    def __init__(
        self, items: Sequence[MissionItem], first: int, navigates: Callable[[MissionItem], bool]
    ) -> None:
        self.items = items
        self.first = first
        self._navigates = navigates
        self._taken: dict[int, int] = {}
        self._tagged: dict[float, int] = {}
        for at, item in enumerate(items):
            if item.command == _CMD.JUMP_TAG:
                self._tagged.setdefault(item.param1, at)

    def reset_jumps(self) -> None:
        """Reset the counts of all jumps."""
        self._taken.clear()

    def jumps_taken(self, seq: int) -> int:
        """Return the count of a jump."""
        return self._taken.get(seq, 0)

    def leg(self, seq: int) -> Leg | None:
        """Return the leg that begins at an item, and count its jumps; None at the end of the mission."""
        actions: list[int] = []
        at = self._follow(seq)
        while at is not None:
            if self._navigates(self.items[at]):
                return Leg(tuple(actions), at, at + 1)
            actions.append(at)
            at = self._follow(at + 1) if len(actions) < MAX_ACTIONS else None
        return Leg(tuple(actions), None, len(self.items)) if actions else None

    def upcoming(self, seq: int, limit: int = 16) -> list[int]:
        """Return the next NAV items from `seq` on, ignoring jumps."""
        following = range(max(seq, self.first), len(self.items))
        return [at for at in following if self._navigates(self.items[at])][:limit]

    def tagged(self, tag: float) -> int | None:
        """Return the item of a JUMP_TAG."""
        return self._tagged.get(tag)

    def _follow(self, seq: int) -> int | None:
        """Return the next item at or after `seq` that is no jump."""
        for _ in range(MAX_JUMPS):
            if not 0 <= seq < len(self.items):
                return None
            item = self.items[seq]
            if item.command not in {_CMD.DO_JUMP, _CMD.DO_JUMP_TAG}:
                return seq
            target = self._target(item)
            if target is None:
                return None
            seq = target if self._take(seq, item.param2) else seq + 1
        return None

    def _target(self, item: MissionItem) -> int | None:
        if item.command == _CMD.DO_JUMP_TAG:
            return self.tagged(item.param1)
        inside = isfinite(item.param1) and self.first <= int(item.param1) < len(self.items)
        return int(item.param1) if inside else None

    def _take(self, seq: int, repeats: float) -> bool:
        if repeats == FOREVER:
            return True
        taken = self._taken.get(seq, 0)
        if not taken < repeats:
            return False
        self._taken[seq] = taken + 1
        return True
