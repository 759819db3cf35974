"""The switches of a transmitter: the AUX channels that switch boxes on, and how to enter one flight mode.

A mode range switches a box on while an AUX channel is between two pulses (MSP_MODE_RANGES); ranges of one
channel may overlap, and a box may have several. To enter a flight mode each AUX channel that has ranges of
flight modes gets the pulse at which that mode is on, and as few others as possible.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

#: The range of pulse widths that a transmitter sends, in microseconds.
MIN_PULSE, MAX_PULSE = 1000, 2000
_STEP: Final = 25


@dataclass(frozen=True, slots=True)
class Switch:
    """A range of an AUX channel, from 0, in which a box is on; microseconds, the upper end excluded."""

    box: int
    aux: int
    start: int
    end: int

    def holds(self, pulse: int) -> bool:
        """Return whether a pulse is in the range."""
        return self.start <= pulse < self.end

    @property
    def middle(self) -> int:
        """The middle of the part of the range that a transmitter reaches."""
        return (max(self.start, MIN_PULSE) + min(self.end, MAX_PULSE)) // 2


class ModeSwitches:
    """The switches of one flight controller."""

    def __init__(self, switches: Iterable[Switch] = ()) -> None:
        self._switches = tuple(switch for switch in switches if switch.start < switch.end)

    def find(self, box: int) -> Switch | None:
        """Return the first switch of a box; None if the box has none."""
        return next((switch for switch in self._switches if switch.box == box), None)

    def channels(self, box: int) -> frozenset[int]:
        """Return the AUX channels, from 0, that switch a box."""
        return frozenset(switch.aux for switch in self._switches if switch.box == box)

    def off_pulses(self, box: int) -> dict[int, int] | None:
        """Return the lowest pulses at which a box is off.

        Returns:
            Pulses by AUX channel, from 0, of all channels that switch the box; None if one always does.
        """
        pulses = {aux: self._off_pulse(box, aux) for aux in sorted(self.channels(box))}
        off = {aux: pulse for aux, pulse in pulses.items() if pulse is not None}
        return off if len(off) == len(pulses) else None

    def _off_pulse(self, box: int, aux: int) -> int | None:
        ranges = [each for each in self._switches if each.box == box and each.aux == aux]
        pulses = range(MIN_PULSE, MAX_PULSE + 1, _STEP)
        return next((pulse for pulse in pulses if not any(each.holds(pulse) for each in ranges)), None)

    def pulses_for(self, mode: int, flight_modes: Collection[int]) -> dict[int, int] | None:
        """Return pulses of AUX channels that enter a flight mode.

        Args:
            mode: The permanent id of its box; one that is no flight mode stands for none of them.
            flight_modes: The permanent ids of all flight modes.

        Returns:
            Pulses by AUX channel, from 0; None if no switch enters the mode.
        """
        ranges = [switch for switch in self._switches if switch.box in flight_modes]
        if mode in flight_modes and not any(switch.box == mode for switch in ranges):
            return None
        home = next((switch.aux for switch in ranges if switch.box == mode), None)
        return {
            aux: _best_pulse([each for each in ranges if each.aux == aux], mode if aux == home else None)
            for aux in sorted({switch.aux for switch in ranges})
        }


def _best_pulse(ranges: list[Switch], mode: int | None) -> int:
    """Return the pulse at which a mode is on, if one is given, and as few other modes as possible."""
    middles = [switch.middle for switch in ranges if switch.box == mode]
    candidates: tuple[int, ...] = (*middles, *range(MIN_PULSE, MAX_PULSE + 1, _STEP))

    def cost(pulse: int) -> tuple[bool, int]:
        on = {switch.box for switch in ranges if switch.holds(pulse)}
        others = sum(box != mode for box in on)
        return mode is not None and mode not in on, others

    return min(candidates, key=cost)
