"""What PX4's failsafes look at: manual control, ground station, battery, motors, and what the mode needs.

Each check gives what is to be done now, or nothing. Manual control that was already lost when the motors were
armed is not missed until it was there again; a battery that was low then is only warned of.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.failsafes import ground_silence
from mavstack.sim.px4 import modes
from mavstack.sim.px4.failsafe_actions import (
    BY_HAND,
    CRITICAL,
    EMERGENCY,
    LOW,
    MODES,
    Act,
    Wanted,
    battery,
    link_loss,
    motor_failure,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.interfaces import Autopilot

_INFO: Final = common.MavSeverity.INFO
#: COM_RC_IN_MODE: sticks are not looked at.
_NO_STICKS: Final = 4
#: Bits of COM_RCL_EXCEPT and COM_DLL_EXCEPT.
_MISSION, _AUTOMATIC, _OFFBOARD = 1, 2, 4
_EXCEPTIONS: Final = {
    modes.MISSION: _MISSION,
    modes.OFFBOARD: _OFFBOARD,
    **dict.fromkeys(
        (modes.HOLD, modes.TAKEOFF, modes.VTOL_TAKEOFF, modes.LAND, modes.RETURN, modes.DESCEND, modes.ORBIT),
        _AUTOMATIC,
    ),
}
#: Seconds between two looks at who was heard: links are lost in seconds.
_LOOK_AT_LINKS: Final = 0.5


class Px4Checks:
    """The checks of one vehicle."""

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self._parameters = autopilot.vehicle.parameters
        self._sticks_lost = True
        self._sticks_lost_at_arming = True
        self._last_heard: float | None = None
        self._station_lost = False
        self._links_due = autopilot.now
        self._warning = self._warning_at_arming = 0
        self._was_armed = False

    def look(self, now: float) -> None:
        """Look at what does not depend on the mode, and say what has changed."""
        armed = self._autopilot.armed
        self._look_at_sticks(now)
        if now >= self._links_due:
            self._links_due = now + _LOOK_AT_LINKS
            self._look_at_station()
        warning = self._battery_warning()
        self._warning = max(self._warning, warning) if armed else warning
        if armed and not self._was_armed:
            self._warning_at_arming = warning
        if not armed or not self._sticks_lost:
            self._sticks_lost_at_arming = self._sticks_lost
        self._was_armed = armed

    def wanted(self, intended: int) -> Iterator[tuple[str, Wanted]]:
        """What is wrong now, by name, if this is the mode that somebody chose."""
        if self._sticks_missed(intended):
            yield "manual control", link_loss(self._int("NAV_RCL_ACT"), "Manual control loss")
        if self._station_missed(intended):
            yield "ground station", link_loss(self._int("NAV_DLL_ACT"), "GCS connection loss")
        if self._warning:
            worse = self._warning > self._warning_at_arming
            action = self._int("COM_LOW_BAT_ACT") if worse else 0
            yield f"battery {self._warning}", battery(action, self._warning)
        if self._int("FD_ACT_EN") and any(what.startswith("motor") for what in self._faults):
            yield "motor", motor_failure(self._int("COM_ACT_FAIL_ACT"))
        fallback = self.fallback_of(intended)
        if fallback is not Act.NONE:
            yield "mode", Wanted(fallback, delayed=False)

    # What a mode needs

    def can_run(self, number: int) -> bool:
        """Whether a mode has what it needs, but for a pilot."""
        autopilot = self._autopilot
        mode = autopilot.find_mode(number)
        if mode is None:
            return False
        if (mode.needs_position or number == modes.LAND) and not autopilot.has_position:
            return False
        return number != modes.RETURN or autopilot.home is not None

    def fallback_of(self, intended: int) -> Act:
        """What is done instead of a mode that lacks what it needs."""
        act = Act.NONE
        if intended == modes.POSITION and not self.can_run(intended):
            act, intended = Act.ALTITUDE, modes.ALTITUDE
        if intended == modes.ALTITUDE and not self.can_run(intended):
            act, intended = Act.STABILIZED, modes.STABILIZED
        if self._sticks_lost and act in BY_HAND:
            act = link_loss(self._int("NAV_RCL_ACT"), "").act
        return act if self.can_run(intended) else Act.RETURN

    def possible(self, act: Act) -> Act:
        """An action, or the next one that can be done."""
        for other in Act:
            if other < act:
                continue
            if other in BY_HAND and not self._sticks_lost and self.can_run(MODES[other]):
                return other
            if other in MODES and other not in BY_HAND and self._can_do(other):
                return other
            if other not in MODES:
                return Act.TERMINATE if other is Act.DISARM and act is not Act.DISARM else other
        return act

    def _can_do(self, act: Act) -> bool:
        if act is Act.DESCEND and self._int("COM_POS_FS_ACT") == 1:
            return False
        return self.can_run(self.mode_of(act))

    def mode_of(self, act: Act) -> int:
        """Its mode; what does not fly holds instead of landing."""
        return self._autopilot.profile.land if act is Act.LAND else MODES[act]

    # Links

    def _look_at_sticks(self, now: float) -> None:
        received_at = self._autopilot.radio.received_at
        lost = now - received_at > float(self._parameters["COM_RC_LOSS_T"])
        if lost == self._sticks_lost:
            return
        self._sticks_lost = lost
        if lost:
            self._last_heard = received_at
            self._send_statustext("Manual control lost")
        elif self._last_heard is not None:
            self._send_statustext(f"Manual control regained after {now - self._last_heard:.1f} s")

    def _sticks_missed(self, intended: int) -> bool:
        if not self._sticks_lost or self._sticks_lost_at_arming:
            return False
        if self._int("COM_RC_IN_MODE") == _NO_STICKS:
            return False
        return not self._int("COM_RCL_EXCEPT") & _EXCEPTIONS.get(intended, 0)

    def _look_at_station(self) -> None:
        silence = ground_silence(self._autopilot)
        lost = silence is not None and silence > float(self._parameters["COM_DL_LOSS_T"])
        if lost != self._station_lost:
            self._station_lost = lost
            self._send_statustext("Connection to ground station lost" if lost else "GCS connection regained")

    def _station_missed(self, intended: int) -> bool:
        if not self._station_lost or not self._autopilot.armed or intended == modes.LAND:
            return False
        return not self._int("COM_DLL_EXCEPT") & _EXCEPTIONS.get(intended, 0)

    # Parts

    def _battery_warning(self) -> int:
        left = self._autopilot.body.battery.remaining
        if left >= float(self._parameters["BAT_LOW_THR"]):
            return 0
        if left < float(self._parameters["BAT_EMERGEN_THR"]):
            return EMERGENCY
        return CRITICAL if left < float(self._parameters["BAT_CRIT_THR"]) else LOW

    @property
    def _faults(self) -> dict[str, str]:
        return self._autopilot.vehicle.faults.active

    def _int(self, name: str) -> int:
        return int(self._parameters[name])

    def _send_statustext(self, text: str) -> None:
        self._autopilot.vehicle.send_statustext(text, _INFO)
