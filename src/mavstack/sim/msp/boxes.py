"""Boxes: the modes of a flight controller, which the AUX channels of the transmitter switch on.

A box has a name and a permanent id. MSP_BOXNAMES and MSP_BOXIDS list the boxes that a controller has, and
MSP_STATUS has one bit for each in this order. A mode range switches a box on while an AUX channel is
between two values.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.msp.messages.modes import BETAFLIGHT_MODES, INAV_MODES
from mavstack.sim.msp.receiver import AUX, CHANNELS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

#: A mode range is in steps of 25 microseconds, counted from 900 microseconds.
STEP, FIRST_STEP, LAST_STEP = 25, 900, 48
#: Number of mode ranges, by the firmware's variant name.
RANGE_COUNTS: Final = {"BTFL": 20, "INAV": 40}


@dataclass(frozen=True, slots=True)
class Box:
    """A box: its name and its permanent id."""

    name: str
    permanent_id: int


@dataclass(frozen=True, slots=True)
class ModeRange:
    """A mode range: the box by its permanent id, the AUX channel from 0, first and last step.

    A range is in use if its first step is below its last one. `logic` 1 means that all ranges with it must
    hold (AND).
    """

    permanent_id: int = 0
    aux_channel: int = 0
    start_step: int = 0
    end_step: int = 0
    logic: int = 0
    linked_to: int = 0

    @property
    def is_used(self) -> bool:
        """True if the range is not empty."""
        return self.start_step < self.end_step

    def holds(self, channels: Sequence[int]) -> bool:
        """Return whether the AUX channel is in the range."""
        index = AUX + self.aux_channel
        if not self.is_used or index >= CHANNELS:
            return False
        step = (min(max(channels[index], FIRST_STEP), 2100) - FIRST_STEP) / STEP
        return self.start_step <= step < self.end_step


class BoxTable:
    """The boxes of one controller."""

    def __init__(self, boxes: Iterable[Box]) -> None:
        self.boxes = tuple(boxes)
        self._by_id = {box.permanent_id: box for box in self.boxes}
        self._by_name = {box.name: box for box in self.boxes}

    def __contains__(self, permanent_id: object) -> bool:
        return permanent_id in self._by_id

    def id_of(self, name: str) -> int | None:
        """Return the permanent id of a box by its name; None if the controller has no such box."""
        box = self._by_name.get(name)
        return None if box is None else box.permanent_id

    def name_of(self, permanent_id: int) -> str:
        """Return the name of a box by its permanent id; empty if the controller has no such box."""
        box = self._by_id.get(permanent_id)
        return "" if box is None else box.name

    def flags(self, names: Iterable[str]) -> int:
        """Return the bits of boxes that are on, in the order of the list."""
        active = set(names)
        return sum(1 << index for index, box in enumerate(self.boxes) if box.name in active)

    def switched_on(self, ranges: Sequence[ModeRange], channels: Sequence[int]) -> frozenset[str]:
        """Return the names of the boxes that the AUX channels switch on.

        Args:
            ranges: The mode ranges.
            channels: All channels in microseconds, in the firmware's order.
        """
        active: set[str] = set()
        refused: set[str] = set()
        for each in ranges:
            if not each.is_used or each.permanent_id not in self._by_id:
                continue
            name = self._by_id[each.permanent_id].name
            if each.logic and not each.holds(channels):
                refused.add(name)
            elif each.holds(channels):
                active.add(name)
        return frozenset(active - refused)


def _table(names: Mapping[int, str], ids: Iterable[int]) -> BoxTable:
    return BoxTable(Box(names[number], number) for number in ids)


#: Boxes of Betaflight 4.5 on a quad with accelerometer, barometer, compass and GPS.
BETAFLIGHT_BOXES: Final = _table(
    BETAFLIGHT_MODES,
    (0, 1, 2, 4, 5, 6, 7, 13, 19, 20, 26, 27, 28, 30, 31, 35, 36, 37, 39, 45, 46, 47, 48, 49, 51, 52, 53, 54),
)
#: Boxes of iNav on a quad with barometer, compass and GPS, in the order of their status bits.
INAV_BOXES: Final = _table(
    INAV_MODES,
    (
        0,
        51,
        61,
        1,
        2,
        35,
        29,
        5,
        8,
        6,
        7,
        32,
        11,
        10,
        28,
        53,
        45,
        30,
        31,
        55,
        59,
        46,
        3,
        13,
        60,
        19,
        26,
        27,
        50,
        52,
    ),
)
