"""Rover's failsafes: radio and ground station have one action, FS_ACTION, and one recovery.

It acts FS_TIMEOUT seconds after the first of them was lost, once, and neither in RTL nor in Hold; armed or
not. All is well again when all of them are.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.sim.ardupilot.failsafes.firmware import ModeFailure
    from mavstack.sim.autopilot.interfaces import Autopilot

_MODE: Final = ardupilotmega.RoverMode
_TERMINATE: Final = 5
#: Modes to try in turn, by FS_ACTION and BATT_FS_LOW_ACT.
_ACTIONS: Final[Mapping[int, tuple[int, ...]]] = MappingProxyType(
    {
        1: (_MODE.RTL, _MODE.HOLD),
        2: (_MODE.HOLD,),
        3: (_MODE.SMART_RTL, _MODE.RTL, _MODE.HOLD),
        4: (_MODE.SMART_RTL, _MODE.HOLD),
        6: (_MODE.LOITER, _MODE.HOLD),
    }
)
#: FS_THR_ENABLE and FS_GCS_ENABLE: a mission is flown on.
_GOES_ON: Final = 2
_ENABLED: Final[Mapping[str, str]] = MappingProxyType({"Radio": "FS_THR_ENABLE", "GCS": "FS_GCS_ENABLE"})
#: A bit of FS_OPTIONS.
_ACTIVE_IN_HOLD: Final = 0


class RoverFailsafes(FirmwareFailsafes):
    """As Rover has them; one of its autopilot's watches."""

    battery_priorities = (_TERMINATE, 2, 1, 4, 3, 0)

    def __init__(self, autopilot: Autopilot, mode_failure: ModeFailure) -> None:
        super().__init__(autopilot, mode_failure)
        self._lost: list[str] = []
        self._since = autopilot.now
        autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Look at the radio, then at the ground station."""
        self._look("Radio", lost=self.radio_lost("FS_THR_ENABLE"))
        self._look("GCS", lost=self.ground_lost("FS_GCS_ENABLE", "FS_GCS_TIMEOUT"))

    def _look(self, cause: str, *, lost: bool) -> None:
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
        mode = self.autopilot.mode.number
        return mode != _MODE.RTL and (mode != _MODE.HOLD or self.option("FS_OPTIONS", _ACTIVE_IN_HOLD))

    def _act(self, cause: str) -> None:
        self.send_statustext(f"{cause} Failsafe")
        self.let_go()
        if self.autopilot.mode.number == _MODE.AUTO and self.number(_ENABLED[cause]) == _GOES_ON:
            self.send_statustext("Failsafe - Continuing Auto Mode")
        else:
            self._do(int(self.number("FS_ACTION")), cause)

    def battery_failsafe(self, word: str, action: int) -> None:
        """BATT_FS_LOW_ACT, BATT_FS_CRT_ACT."""
        self._do(action, "Battery")

    def _do(self, action: int, cause: str) -> None:
        if action == _TERMINATE:
            self.disarm(cause)
            return
        for mode in _ACTIONS.get(action, ()):
            if self.enter(mode, cause):
                return
