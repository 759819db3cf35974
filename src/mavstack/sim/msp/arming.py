"""Arming: the reasons that forbid it, and the switch that does it.

Each firmware has a list of reasons with one bit each in MSP_STATUS_EX (iNav: MSP2_INAV_STATUS). The box ARM
arms when there is no reason, and disarms when it goes off. A switch that was on while there was a reason
must go off first: ARM_SWITCH.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.msp.messages.arming import FIRST_INAV_REASON, ArmingDisableFlag, InavArmingFlag

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

#: The bit of ARM_SWITCH, which is the last bit in Betaflight 4.5.
_ARM_SWITCH_BIT: Final = 25
_SWITCH: Final = "ARM_SWITCH"
#: Bit numbers of the reasons that forbid arming in Betaflight 4.5.
BETAFLIGHT_REASONS: Final[Mapping[str, int]] = {
    str(flag.name): flag.bit_length() - 1 for flag in ArmingDisableFlag if flag < 1 << _ARM_SWITCH_BIT
} | {_SWITCH: _ARM_SWITCH_BIT}
#: Bit numbers of the reasons that forbid arming in iNav.
INAV_REASONS: Final[Mapping[str, int]] = {
    str(flag.name): flag.bit_length() - 1 for flag in InavArmingFlag if flag >= FIRST_INAV_REASON
}


class Arming:
    """The arming state of one controller.

    Args:
        bits: The reasons of the firmware by their bits.
        on_change: Called after arming and disarming with the new state and the reason.
    """

    def __init__(self, bits: Mapping[str, int], on_change: Callable[[bool, str], None]) -> None:
        self._bits, self._on_change = bits, on_change
        self.armed = False
        self.was_ever_armed = False
        #: The reasons that forbid arming now, in the order of their bits.
        self.reasons: tuple[str, ...] = ()
        self._latched = False

    @property
    def flags(self) -> int:
        """The bits of the reasons."""
        return sum(1 << self._bits[name] for name in self.reasons)

    def step(self, reasons: Iterable[str], switch_on: bool) -> None:
        """Arm or disarm by the switch.

        Args:
            reasons: What forbids arming now, without the switch.
            switch_on: The box ARM is on.
        """
        present = set(reasons)
        if not switch_on:
            self._latched = False
        elif not self.armed and present:
            self._latched = True
        if self._latched and not self.armed:
            present.add(_SWITCH)
        self.reasons = tuple(name for name in self._bits if name in present)
        if self.armed and not switch_on:
            self.disarm("switch")
        elif switch_on and not self.armed and not self.reasons:
            self.armed = self.was_ever_armed = True
            self._on_change(True, "switch")

    def disarm(self, reason: str) -> None:
        """Disarm; the switch must go off before it arms again."""
        if self.armed:
            self.armed, self._latched = False, True
            self._on_change(False, reason)
