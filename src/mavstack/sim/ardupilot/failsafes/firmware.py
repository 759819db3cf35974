"""What the failsafes of Copter, Plane, Rover and Sub have in common: watching, saying, entering modes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.sim.autopilot.failsafes import Failsafe, ground_silence, nothing, radio_lost

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.interfaces import Autopilot, Mode

#: Why a mode cannot be entered, as the firmware says it; None if it can be.
ModeFailure: TypeAlias = "Callable[[Autopilot, Mode], str | None]"
WARNING: Final = common.MavSeverity.WARNING
CRITICAL: Final = common.MavSeverity.CRITICAL


class FirmwareFailsafes:
    """The base of each firmware's."""

    #: A battery's actions that go before others, the most urgent first; what is not here comes last.
    battery_priorities: tuple[int, ...] = ()

    def __init__(self, autopilot: Autopilot, mode_failure: ModeFailure) -> None:
        self.autopilot = autopilot
        self._mode_failure = mode_failure
        self.parameters = autopilot.vehicle.parameters

    def battery_failsafe(self, word: str, action: int) -> None:
        """Do what BATT_FS_LOW_ACT or BATT_FS_CRT_ACT says."""

    # What is wrong

    def radio_lost(self, enabled: str) -> bool:
        """Whether the radio is lost, if anybody is to mind."""
        return self.number(enabled) > 0 and radio_lost(self.autopilot)

    def ground_lost(self, enabled: str, timeout: str) -> bool:
        """Whether the ground station that was there has been silent for too long."""
        if self.number(enabled) <= 0:
            return False
        silence = ground_silence(self.autopilot)
        return silence is not None and silence > self.number(timeout)

    # What is done

    def watch(
        self,
        name: str,
        is_wrong: Callable[[], bool],
        patience: Callable[[], float],
        begin: Callable[[], None],
        end: Callable[[], None] = nothing,
    ) -> None:
        """Look at it on every tick."""
        self.autopilot.watches.append(Failsafe(self.autopilot, name, is_wrong, patience, begin, end))

    def enter(self, number: int, cause: str) -> bool:
        """Enter a mode, or say why it cannot be; to stay in it counts."""
        autopilot = self.autopilot
        mode = autopilot.find_mode(number)
        if mode is None:
            return False
        if autopilot.mode.number == number:
            return True
        failure = self._mode_failure(autopilot, mode)
        if failure is not None:
            self.send_statustext(failure)
            return False
        return autopilot.enter(number, f"{cause} failsafe")

    def disarm(self, cause: str) -> None:
        """Motors off, wherever it is."""
        self.autopilot.disarm(f"{cause} failsafe")

    def let_go(self) -> None:
        """Forget channels that are overridden over the link: the radio control has them again."""
        self.autopilot.radio.clear_overrides()

    def send_statustext(self, text: str, severity: int = WARNING) -> None:
        """By STATUSTEXT."""
        self.autopilot.vehicle.send_statustext(text, severity)

    def number(self, parameter: str) -> float:
        """The value of a parameter; 0 if this firmware does not have it."""
        return float(self.parameters.get(parameter, 0.0))

    def option(self, parameter: str, bit: int) -> bool:
        """Whether a bit of a parameter is set."""
        return bool(int(self.number(parameter)) >> bit & 1)
