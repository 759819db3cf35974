"""In which order the items of a mission are flown: the jumps, and how often each was taken.

An item that navigates ends a leg; the items before it that only do something belong to that leg. Jumps are
no items of a leg: they say where the search for the next one goes on. A jump is counted when a leg is taken
through it. A loop of jumps alone, or of items that only do something, ends the mission.
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
MOST_JUMPS = 64
MOST_ACTIONS = 255


@dataclass(frozen=True, slots=True)
class Leg:
    """What is done on the way, and the item that is flown; None after the last one."""

    actions: tuple[int, ...]
    navigation: int | None
    #: Where the next leg's search begins.
    then: int


class Route:
    """A mission's items, and the jumps taken so far."""

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

    def forget_jumps(self) -> None:
        """Count from the beginning."""
        self._taken.clear()

    def jumps_taken(self, seq: int) -> int:
        """How often the jump of an item was taken."""
        return self._taken.get(seq, 0)

    def leg(self, seq: int) -> Leg | None:
        """The leg that begins at an item, jumps counted; None at the end of the mission."""
        actions: list[int] = []
        at = self._follow(seq)
        while at is not None:
            if self._navigates(self.items[at]):
                return Leg(tuple(actions), at, at + 1)
            actions.append(at)
            at = self._follow(at + 1) if len(actions) < MOST_ACTIONS else None
        return Leg(tuple(actions), None, len(self.items)) if actions else None

    def upcoming(self, seq: int, most: int = 16) -> list[int]:
        """The items that navigate from one on, as they stand, jumps left aside."""
        following = range(max(seq, self.first), len(self.items))
        return [at for at in following if self._navigates(self.items[at])][:most]

    def tagged(self, tag: float) -> int | None:
        """The item that a tag marks."""
        return self._tagged.get(tag)

    def _follow(self, seq: int) -> int | None:
        """The next item at or after `seq` that is no jump."""
        for _ in range(MOST_JUMPS):
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
