"""Plane's failsafes: a short and a long one for the radio, and a long one for the ground station.

THR_FAILSAFE enables the radio failsafes. The short one enters a mode that keeps the position (FS_SHORT_ACTN)
until the radio is back; the long one returns home (FS_LONG_ACTN). Automatic modes take neither action unless
these parameters select one.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.ardupilot.behaviours import land_by_mission
from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.sim.ardupilot.failsafes.firmware import ModeFailure
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

_MODE: Final = ardupilotmega.PlaneMode
_INFO: Final = common.MavSeverity.INFO
#: Values of FS_SHORT_ACTN: 0 best guess, 1 circle, 2 glide (FBWA), 3 disabled, 4 FBWB.
_BEST_GUESS, _DISABLED = 0, 3
_SHORT_MODES: Final[Mapping[int, int]] = MappingProxyType({2: _MODE.FLY_BY_WIRE_A, 4: _MODE.FLY_BY_WIRE_B})
#: Values of FS_LONG_ACTN: 0 continue, 1 RTL, 2 glide (FBWA), 3 parachute, 4 mission.
_CONTINUE, _RETURN, _PARACHUTE, _INTO_AUTO = 0, 1, 3, 4
_LONG_MODES: Final[Mapping[int, int]] = MappingProxyType({2: _MODE.FLY_BY_WIRE_A, 4: _MODE.AUTO})
#: Value of FS_GCS_ENABL: the failsafe starts only in AUTO.
_ONLY_IN_AUTO: Final = 3
#: Values of BATT_FS_LOW_ACT.
_RTL, _LAND, _TERMINATE, _QLAND, _LOITER_QLAND, _AUTOLAND = 1, 2, 3, 4, 6, 7
#: Bit numbers of Q_OPTIONS.
_QRTL_BIT, _RTL_BIT = 5, 20

_MANUAL_MODES: Final = frozenset(
    {
        _MODE.MANUAL, _MODE.STABILIZE, _MODE.ACRO, _MODE.FLY_BY_WIRE_A, _MODE.FLY_BY_WIRE_B,
        _MODE.CRUISE, _MODE.TRAINING, _MODE.AUTOTUNE,
    }
)  # fmt: skip
_HOVER_MODES: Final = frozenset({_MODE.QSTABILIZE, _MODE.QHOVER, _MODE.QLOITER})
_AUTOMATIC_MODES: Final = frozenset({_MODE.AUTO, _MODE.GUIDED})
_LANDING_MODES: Final = frozenset({_MODE.QLAND, _MODE.LOITER_ALT_QLAND})


class PlaneFailsafes(FirmwareFailsafes):
    """The failsafes of Plane."""

    battery_priorities = (_TERMINATE, 5, _LOITER_QLAND, _QLAND, _LAND, _RTL, _AUTOLAND, 0)

    def __init__(self, autopilot: SimulatedAutopilot, mode_failure: ModeFailure) -> None:
        super().__init__(autopilot, mode_failure)
        #: The mode before the short failsafe, and the mode that the failsafe entered; None without a mode
        #: change.
        self._before: tuple[int, int] | None = None
        self.add(
            "throttle",
            self._radio_lost,
            lambda: self.number("RC_FS_TIMEOUT"),
            lambda: self.send_statustext("Throttle failsafe on"),
            lambda: self.send_statustext("Throttle failsafe off"),
        )
        self.add(
            "radio",
            lambda: self._radio_lost() and self.number("FS_SHORT_ACTN") != _DISABLED,
            lambda: self.number("FS_SHORT_TIMEOUT"),
            self._begin_short,
            self._end_short,
        )
        self.add(
            "radio long",
            self._radio_lost,
            lambda: self.number("FS_LONG_TIMEOUT"),
            lambda: self._begin_long("RC Long"),
            lambda: self.send_statustext("RC Long Failsafe Cleared"),
        )
        self.add(
            "ground",
            self._ground_lost,
            lambda: 0.0,
            lambda: self._begin_long("GCS"),
            lambda: self.send_statustext("GCS Failsafe Cleared"),
        )

    def _radio_lost(self) -> bool:
        """Return whether the radio is lost."""
        return self.number("THR_FAILSAFE") == 1 and self.radio_lost("THR_FAILSAFE")

    def _ground_lost(self) -> bool:
        """Return whether the ground station is lost."""
        only_in_auto = self.number("FS_GCS_ENABL") == _ONLY_IN_AUTO
        if only_in_auto and self.autopilot.mode.number != _MODE.AUTO and not self._is_active("ground"):
            return False
        return self.ground_lost("FS_GCS_ENABL", "FS_LONG_TIMEOUT")

    def _is_active(self, name: str) -> bool:
        """Return whether a failsafe is active."""
        return name in self.autopilot.failsafes

    # Radio

    def _begin_short(self) -> None:
        """Begin the short failsafe."""
        before = self.autopilot.mode.number
        target_mode = self._short_mode(before)
        if target_mode is not None and target_mode != before and self.enter(target_mode, "Radio"):
            self._before = before, target_mode
            self.send_statustext(f"RC Short Failsafe: switched to {self.autopilot.mode.name}")
        else:
            self.send_statustext("RC Short Failsafe On")

    def _short_mode(self, mode: int) -> int | None:
        """Return the mode of the short failsafe; None to change nothing."""
        action = int(self.number("FS_SHORT_ACTN"))
        if mode in _HOVER_MODES:
            return self._hover_action()
        acts = mode in _MANUAL_MODES or (
            mode in (*_AUTOMATIC_MODES, _MODE.LOITER) and action != _BEST_GUESS and not self._is_landing()
        )
        return int(_SHORT_MODES.get(action, _MODE.CIRCLE)) if acts else None

    def _end_short(self) -> None:
        """End the short failsafe, and restore the mode."""
        if self._is_active("radio long"):
            return
        self.send_statustext("RC Short Failsafe Cleared")
        before, self._before = self._before, None
        if before is not None and self.autopilot.mode.number == before[1] and self.enter(before[0], "no"):
            self.send_statustext(f"Flight mode {self.autopilot.mode.name} restored", _INFO)

    def _begin_long(self, cause: str) -> None:
        """Begin a long failsafe."""
        self.clear_overrides()
        self._before = None
        target_mode = self._long_mode(self.autopilot.mode.number)
        if target_mode is not None:
            self.enter(target_mode, cause)
        self.send_statustext(f"{cause} Failsafe On: switched to {self.autopilot.mode.name}")

    def _long_mode(self, mode: int) -> int | None:
        """Return the mode of a long failsafe; None to change nothing."""
        action = int(self.number("FS_LONG_ACTN"))
        if mode in _HOVER_MODES:
            return self._hover_action()
        if action == _PARACHUTE or (mode == _MODE.AUTO and self._is_landing()):
            return None
        if mode in _AUTOMATIC_MODES and action == _CONTINUE:
            return None
        if mode in (*_MANUAL_MODES, *_AUTOMATIC_MODES, _MODE.CIRCLE, _MODE.LOITER, _MODE.TAKEOFF):
            return int(_LONG_MODES.get(action, _MODE.RTL))
        return int(_MODE.AUTO) if mode == _MODE.RTL and action == _INTO_AUTO else None

    def _hover_action(self) -> int:
        """Return the mode of a failsafe in hover."""
        if self.option("Q_OPTIONS", _RTL_BIT):
            return int(_MODE.RTL)
        return int(_MODE.QRTL if self.option("Q_OPTIONS", _QRTL_BIT) else _MODE.QLAND)

    def _is_landing(self) -> bool:
        """Return whether the vehicle is landing."""
        behaviour = self.autopilot.behaviour
        return self.autopilot.mode.number in _LANDING_MODES or (behaviour is not None and behaviour.landing)

    # Battery

    def battery_failsafe(self, level: str, action: int) -> None:
        """Execute BATT_FS_LOW_ACT or BATT_FS_CRT_ACT."""
        if action == _TERMINATE:
            if self.number("AFS_ENABLE"):
                self.send_statustext(f"Terminating due to {level} battery", common.MavSeverity.CRITICAL)
                self.autopilot.terminate()
            else:
                self.send_statustext("AFS not enabled, can't terminate the vehicle", _INFO)
            return
        if action in (_QLAND, _LOITER_QLAND) and self.enter(_MODE.QLAND, "Battery"):
            return
        if action in (_RTL, _LAND, _QLAND, _LOITER_QLAND, _AUTOLAND) and not self._is_landing():
            landing = action not in (_RTL, _AUTOLAND) and land_by_mission(self.autopilot, "Battery failsafe")
            if not landing:
                self.enter(_MODE.RTL, "Battery")
