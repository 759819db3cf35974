"""Rover's failsafes: radio and ground station share one action, FS_ACTION, and one recovery.

The action is executed once, FS_TIMEOUT seconds after the first loss, armed or not, but not in RTL or Hold.
The failsafe clears when both are back.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.sim.ardupilot.failsafes.firmware import ModeFailure
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

_MODE: Final = ardupilotmega.RoverMode
_TERMINATE: Final = 5
#: Modes to try in turn, by the value of FS_ACTION or BATT_FS_LOW_ACT.
_ACTIONS: Final[Mapping[int, tuple[int, ...]]] = MappingProxyType(
    {
        1: (_MODE.RTL, _MODE.HOLD),
        2: (_MODE.HOLD,),
        3: (_MODE.SMART_RTL, _MODE.RTL, _MODE.HOLD),
        4: (_MODE.SMART_RTL, _MODE.HOLD),
        6: (_MODE.LOITER, _MODE.HOLD),
    }
)
#: Value of FS_THR_ENABLE and FS_GCS_ENABLE: continue a mission in AUTO.
_CONTINUE_MISSION: Final = 2
_ENABLED: Final[Mapping[str, str]] = MappingProxyType({"Radio": "FS_THR_ENABLE", "GCS": "FS_GCS_ENABLE"})
#: Bit of FS_OPTIONS: failsafes are active in HOLD mode.
_ACTIVE_IN_HOLD: Final = 0


class RoverFailsafes(FirmwareFailsafes):
    """The failsafes of Rover; one of the autopilot's periodic checks."""

    battery_priorities = (_TERMINATE, 2, 1, 4, 3, 0)

    def __init__(self, autopilot: SimulatedAutopilot, mode_failure: ModeFailure) -> None:
        super().__init__(autopilot, mode_failure)
        self._lost: list[str] = []
        self._since = autopilot.now
        autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Check the radio, then the ground station."""
        self._update("Radio", lost=self.radio_lost("FS_THR_ENABLE"))
        self._update("GCS", lost=self.ground_lost("FS_GCS_ENABLE", "FS_GCS_TIMEOUT"))

    def _update(self, cause: str, *, lost: bool) -> None:
        """Update one cause, and act when due."""
        failsafes = self.autopilot.failsafes
        if lost and cause not in self._lost:
            if not self._lost:
                self._since = self.autopilot.now
            self._lost.append(cause)
        elif not lost and cause in self._lost:
            self._lost.remove(cause)
            if "radio or ground" in failsafes and not self._lost:
                failsafes.discard("radio or ground")
                self.send_statustext(f"{cause} Failsafe Cleared", common.MavSeverity.INFO)
        if not self._lost or "radio or ground" in failsafes or not self._may_act():
            return
        if self.autopilot.now - self._since > self.number("FS_TIMEOUT"):
            failsafes.add("radio or ground")
            self._act(self._lost[0])

    def _may_act(self) -> bool:
        """Return whether the mode allows an action."""
        mode = self.autopilot.mode.number
        return mode != _MODE.RTL and (mode != _MODE.HOLD or self.option("FS_OPTIONS", _ACTIVE_IN_HOLD))

    def _act(self, cause: str) -> None:
        """Report and execute FS_ACTION."""
        self.send_statustext(f"{cause} Failsafe")
        self.clear_overrides()
        if self.autopilot.mode.number == _MODE.AUTO and self.number(_ENABLED[cause]) == _CONTINUE_MISSION:
            self.send_statustext("Failsafe - Continuing Auto Mode")
        else:
            self._perform(int(self.number("FS_ACTION")), cause)

    def battery_failsafe(self, level: str, action: int) -> None:
        """Execute BATT_FS_LOW_ACT or BATT_FS_CRT_ACT."""
        self._perform(action, "Battery")

    def _perform(self, action: int, cause: str) -> None:
        """Execute an action."""
        if action == _TERMINATE:
            self.disarm(cause)
            return
        for mode in _ACTIONS.get(action, ()):
            if self.enter(mode, cause):
                return
