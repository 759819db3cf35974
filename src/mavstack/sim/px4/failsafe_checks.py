"""Conditions of PX4's failsafes: manual control, ground station, battery, motors, requirements of the mode.

Each check requests an action or none. Manual control that was already lost at arming is ignored until it has
been received; a battery that was already low at arming only gives a warning.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.failsafes import ground_silence
from mavstack.sim.px4 import modes
from mavstack.sim.px4.failsafe_actions import (
    CRITICAL,
    EMERGENCY,
    LOW,
    MANUAL_ACTIONS,
    MODES,
    Action,
    ActionRequest,
    battery,
    link_loss,
    motor_failure,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


_INFO: Final = common.MavSeverity.INFO
#: Value of COM_RC_IN_MODE that disables manual control.
_MANUAL_CONTROL_DISABLED: Final = 4
#: Bits of COM_RCL_EXCEPT and COM_DLL_EXCEPT: modes in which the loss of a link starts no failsafe.
_MISSION, _AUTOMATIC, _OFFBOARD = 1, 2, 4
_EXCEPTIONS: Final = {
    modes.MISSION: _MISSION,
    modes.OFFBOARD: _OFFBOARD,
    **dict.fromkeys(
        (modes.HOLD, modes.TAKEOFF, modes.VTOL_TAKEOFF, modes.LAND, modes.RETURN, modes.DESCEND, modes.ORBIT),
        _AUTOMATIC,
    ),
}
#: Interval in seconds at which the link to the ground station is checked.
_LINK_CHECK_INTERVAL: Final = 0.5


class FailsafeChecks:
    """The checks of one vehicle."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self._parameters = autopilot.vehicle.parameters
        self._manual_control_lost = True
        self._manual_control_lost_at_arming = True
        self._last_received_at: float | None = None
        self._station_lost = False
        self._links_due = autopilot.now
        self._warning = self._warning_at_arming = 0
        self._was_armed = False

    def update(self, now: float) -> None:
        """Update the conditions that do not depend on the mode, and report changes."""
        armed = self._autopilot.armed
        self._update_manual_control(now)
        if now >= self._links_due:
            self._links_due = now + _LINK_CHECK_INTERVAL
            self._update_ground_station()
        warning = self._battery_warning()
        self._warning = max(self._warning, warning) if armed else warning
        if armed and not self._was_armed:
            self._warning_at_arming = warning
        if not armed or not self._manual_control_lost:
            self._manual_control_lost_at_arming = self._manual_control_lost
        self._was_armed = armed

    def requests(self, intended: int) -> Iterator[tuple[str, ActionRequest]]:
        """Yield the requests of failing conditions by name, for the mode that the user chose."""
        if self._manual_control_failed(intended):
            yield "manual control", link_loss(self._int("NAV_RCL_ACT"), "Manual control loss")
        if self._ground_station_failed(intended):
            yield "ground station", link_loss(self._int("NAV_DLL_ACT"), "GCS connection loss")
        if self._warning:
            worse = self._warning > self._warning_at_arming
            action = self._int("COM_LOW_BAT_ACT") if worse else 0
            yield f"battery {self._warning}", battery(action, self._warning)
        if self._int("FD_ACT_EN") and any(name.startswith("motor") for name in self._faults):
            yield "motor", motor_failure(self._int("COM_ACT_FAIL_ACT"))
        fallback = self.fallback_of(intended)
        if fallback is not Action.NONE:
            yield "mode", ActionRequest(fallback, delayed=False)

    # Requirements of modes

    def can_run(self, number: int) -> bool:
        """Return whether a mode has what it needs, apart from a pilot."""
        autopilot = self._autopilot
        mode = autopilot.find_mode(number)
        if mode is None:
            return False
        if (mode.needs_position or number == modes.LAND) and not autopilot.has_position:
            return False
        return number != modes.RETURN or autopilot.home is not None

    def fallback_of(self, intended: int) -> Action:
        """Return the action that replaces a mode whose requirements fail."""
        action = Action.NONE
        if intended == modes.POSITION and not self.can_run(intended):
            action, intended = Action.ALTITUDE, modes.ALTITUDE
        if intended == modes.ALTITUDE and not self.can_run(intended):
            action, intended = Action.STABILIZED, modes.STABILIZED
        if self._manual_control_lost and action in MANUAL_ACTIONS:
            action = link_loss(self._int("NAV_RCL_ACT"), "").action
        return action if self.can_run(intended) else Action.RETURN

    def available_action(self, action: Action) -> Action:
        """Return the action, or the next more urgent one that is possible."""
        for other in Action:
            if other < action:
                continue
            if other in MANUAL_ACTIONS and not self._manual_control_lost and self.can_run(MODES[other]):
                return other
            if other in MODES and other not in MANUAL_ACTIONS and self._is_available(other):
                return other
            if other not in MODES:
                return Action.TERMINATE if other is Action.DISARM and action is not Action.DISARM else other
        return action

    def _is_available(self, action: Action) -> bool:
        """Return whether an automatic action is possible."""
        if action is Action.DESCEND and self._int("COM_POS_FS_ACT") == 1:
            return False
        return self.can_run(self.mode_of(action))

    def mode_of(self, action: Action) -> int:
        """Return the mode of an action; vehicles that do not fly hold instead of landing."""
        return self._autopilot.profile.land if action is Action.LAND else MODES[action]

    # Links

    def _update_manual_control(self, now: float) -> None:
        """Detect loss and return of manual control."""
        received_at = self._autopilot.radio.received_at
        lost = now - received_at > float(self._parameters["COM_RC_LOSS_T"])
        if lost == self._manual_control_lost:
            return
        self._manual_control_lost = lost
        if lost:
            self._last_received_at = received_at
            self._send_statustext("Manual control lost")
        elif self._last_received_at is not None:
            self._send_statustext(f"Manual control regained after {now - self._last_received_at:.1f} s")

    def _manual_control_failed(self, intended: int) -> bool:
        """Return whether the loss of manual control counts in a mode."""
        if not self._manual_control_lost or self._manual_control_lost_at_arming:
            return False
        if self._int("COM_RC_IN_MODE") == _MANUAL_CONTROL_DISABLED:
            return False
        return not self._int("COM_RCL_EXCEPT") & _EXCEPTIONS.get(intended, 0)

    def _update_ground_station(self) -> None:
        """Detect loss and return of the ground station."""
        silence = ground_silence(self._autopilot)
        lost = silence is not None and silence > float(self._parameters["COM_DL_LOSS_T"])
        if lost != self._station_lost:
            self._station_lost = lost
            self._send_statustext("Connection to ground station lost" if lost else "GCS connection regained")

    def _ground_station_failed(self, intended: int) -> bool:
        """Return whether the loss of the ground station counts in a mode."""
        if not self._station_lost or not self._autopilot.armed or intended == modes.LAND:
            return False
        return not self._int("COM_DLL_EXCEPT") & _EXCEPTIONS.get(intended, 0)

    # Components

    def _battery_warning(self) -> int:
        """Return the warning level of the battery, 0 to 3."""
        left = self._autopilot.body.battery.remaining
        if left >= float(self._parameters["BAT_LOW_THR"]):
            return 0
        if left < float(self._parameters["BAT_EMERGEN_THR"]):
            return EMERGENCY
        return CRITICAL if left < float(self._parameters["BAT_CRIT_THR"]) else LOW

    @property
    def _faults(self) -> dict[str, str]:
        """Injected faults by name."""
        return self._autopilot.vehicle.faults.active

    def _int(self, name: str) -> int:
        """Return a parameter as an integer."""
        return int(self._parameters[name])

    def _send_statustext(self, text: str) -> None:
        """Send a status text."""
        self._autopilot.vehicle.send_statustext(text, _INFO)
