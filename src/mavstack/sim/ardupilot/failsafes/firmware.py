"""Base class of the failsafes of Copter, Plane, Rover and Sub."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.sim.autopilot.failsafes import Failsafe, ground_silence, nothing, radio_lost

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.firmware_profile import Mode

#: Returns the firmware's status text about why a mode cannot be entered; None if the mode can be entered.
ModeFailure: TypeAlias = "Callable[[SimulatedAutopilot, Mode], str | None]"
WARNING: Final = common.MavSeverity.WARNING
CRITICAL: Final = common.MavSeverity.CRITICAL


class FirmwareFailsafes:
    """Conditions and actions that all firmwares share."""

    #: Battery actions, the most urgent first; actions that are not listed are the least urgent.
    battery_priorities: tuple[int, ...] = ()

    def __init__(self, autopilot: SimulatedAutopilot, mode_failure: ModeFailure) -> None:
        self.autopilot = autopilot
        self._mode_failure = mode_failure
        self.parameters = autopilot.vehicle.parameters

    def battery_failsafe(self, level: str, action: int) -> None:
        """Execute BATT_FS_LOW_ACT or BATT_FS_CRT_ACT."""

    # Conditions

    def radio_lost(self, enabled: str) -> bool:
        """Return whether the radio is lost while its failsafe is enabled."""
        return self.number(enabled) > 0 and radio_lost(self.autopilot)

    def ground_lost(self, enabled: str, timeout: str) -> bool:
        """Return whether a ground station that was connected has been silent for too long."""
        if self.number(enabled) <= 0:
            return False
        silence = ground_silence(self.autopilot)
        return silence is not None and silence > self.number(timeout)

    # Actions

    def add(
        self,
        name: str,
        condition: Callable[[], bool],
        delay: Callable[[], float],
        on_begin: Callable[[], None],
        on_end: Callable[[], None] = nothing,
    ) -> None:
        """Register a failsafe that is checked on every tick.

        Args:
            name: Name among the autopilot's active failsafes.
            condition: Returns whether the condition holds.
            delay: Returns the seconds for which it must hold.
            on_begin: Called when the failsafe triggers.
            on_end: Called when it clears.
        """
        self.autopilot.watches.append(Failsafe(self.autopilot, name, condition, delay, on_begin, on_end))

    def enter(self, number: int, cause: str) -> bool:
        """Enter a mode, or report why not; return whether the vehicle is in it."""
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
        """Stop the motors, in the air too."""
        self.autopilot.disarm(f"{cause} failsafe")

    def clear_overrides(self) -> None:
        """Clear overrides of RC channels by the link."""
        self.autopilot.radio.clear_overrides()

    def send_statustext(self, text: str, severity: int = WARNING) -> None:
        """Send a status text."""
        self.autopilot.vehicle.send_statustext(text, severity)

    def number(self, parameter: str) -> float:
        """Return the value of a parameter; 0 if the firmware does not have it."""
        return float(self.parameters.get(parameter, 0.0))

    def option(self, parameter: str, bit: int) -> bool:
        """Return whether a bit of a parameter is set."""
        return bool(int(self.number(parameter)) >> bit & 1)
