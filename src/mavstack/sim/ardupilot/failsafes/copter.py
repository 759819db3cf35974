"""Copter's failsafes: FS_THR_ENABLE, FS_GCS_ENABLE, BATT_FS_*_ACT, and FS_OPTIONS that lets it go on.

What stands on the ground is disarmed. An action that cannot be done falls back: SmartRTL to RTL or Land, RTL
to Land.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega
from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.sim.ardupilot.failsafes.firmware import ModeFailure
    from mavstack.sim.autopilot.interfaces import Autopilot

_MODE: Final = ardupilotmega.CopterMode
#: Actions, as BATT_FS_LOW_ACT numbers them.
NONE, LAND, RTL, SMART_RTL, SMART_RTL_OR_LAND, TERMINATE, AUTO_RTL, BRAKE = range(8)
#: By the values of FS_THR_ENABLE and FS_GCS_ENABLE; any other means Land and RTL.
_BY_RADIO: Final[Mapping[int, int]] = MappingProxyType(
    {0: NONE, 1: RTL, 2: RTL, 3: LAND, 4: SMART_RTL, 5: SMART_RTL_OR_LAND, 6: AUTO_RTL, 7: BRAKE}
)
_BY_GROUND: Final[Mapping[int, int]] = MappingProxyType(
    {0: NONE, 1: RTL, 2: RTL, 3: SMART_RTL, 4: SMART_RTL_OR_LAND, 5: LAND, 6: AUTO_RTL, 7: BRAKE}
)
#: Bits of FS_OPTIONS.
_RADIO_IN_AUTO, _GROUND_IN_AUTO, _RADIO_IN_GUIDED, _LANDING, _GROUND_BY_HAND, _GRIPPER = range(6)
_THROTTLE_CLOSED: Final = 0.01
#: So soon after arming it is disarmed again.
_ARMING_DELAY: Final = 2.0
_ZERO_THROTTLE_MODES: Final = frozenset({_MODE.STABILIZE, _MODE.ACRO})


class CopterFailsafes(FirmwareFailsafes):
    """As Copter has them."""

    battery_priorities = (TERMINATE, LAND, RTL, SMART_RTL_OR_LAND, SMART_RTL, NONE)

    def __init__(self, autopilot: Autopilot, mode_failure: ModeFailure) -> None:
        super().__init__(autopilot, mode_failure)
        self._battery_lands = False
        self.watch(
            "radio",
            lambda: self.radio_lost("FS_THR_ENABLE"),
            lambda: self.number("RC_FS_TIMEOUT"),
            self._radio,
            lambda: self.send_statustext("Radio Failsafe Cleared"),
        )
        self.watch(
            "ground",
            lambda: self.ground_lost("FS_GCS_ENABLE", "FS_GCS_TIMEOUT"),
            lambda: 0.0,
            self._ground,
            lambda: self.send_statustext("GCS Failsafe Cleared"),
        )

    # What it does about each

    def _radio(self) -> None:
        action = _BY_RADIO.get(int(self.number("FS_THR_ENABLE")), LAND)
        mode = self.autopilot.mode.number
        if self._should_disarm():
            self._announce("Radio", "Disarming")
            self.disarm("Radio")
        elif self._goes_on_landing("Radio", action):
            self._do(LAND, "Radio")
        elif mode == _MODE.AUTO and self.option("FS_OPTIONS", _RADIO_IN_AUTO):
            self._announce("Radio", "Continuing Auto")
        elif mode == _MODE.GUIDED and self.option("FS_OPTIONS", _RADIO_IN_GUIDED):
            self._announce("Radio", "Continuing Guided Mode")
        else:
            self._announce("Radio")
            self._do(action, "Radio")

    def _ground(self) -> None:
        self.let_go()
        action = _BY_GROUND.get(int(self.number("FS_GCS_ENABLE")), RTL)
        autopilot = self.autopilot
        if not autopilot.armed:
            self._announce("GCS")
        elif self._should_disarm():
            self.disarm("GCS")
            self._announce("GCS", "Disarming")
        elif self._goes_on_landing("GCS", action):
            self._do(LAND, "GCS")
        elif autopilot.mode.number == _MODE.AUTO and self.option("FS_OPTIONS", _GROUND_IN_AUTO):
            self._announce("GCS", "Continuing Auto Mode")
        elif autopilot.mode.manual_control and self.option("FS_OPTIONS", _GROUND_BY_HAND):
            self._announce("GCS", "Continuing Pilot Control")
        else:
            self._announce("GCS")
            self._do(action, "GCS")

    def battery_failsafe(self, word: str, action: int) -> None:
        """BATT_FS_LOW_ACT, BATT_FS_CRT_ACT."""
        self._battery_lands = action in (LAND, TERMINATE)
        if self._should_disarm():
            self.disarm("Battery")
            self._announce("Battery", "Disarming")
        elif action != NONE and self._is_landing() and self.option("FS_OPTIONS", _LANDING):
            self._announce("Battery", "Continuing Landing")
            self._do(LAND, "Battery")
        else:
            self._announce("Battery")
            self._do(action, "Battery")

    # Parts

    def _announce(self, cause: str, done: str = "") -> None:
        self.send_statustext(f"{cause} Failsafe - {done}" if done else f"{cause} Failsafe")

    def _goes_on_landing(self, cause: str, action: int) -> bool:
        """Whether it lands already, and nothing shall keep it from that."""
        if not self._is_landing():
            return False
        if self._battery_lands and {"battery low", "battery critical"} & self.autopilot.failsafes:
            self._announce(f"{cause} + Battery", "Continuing Landing")
            return True
        if self.option("FS_OPTIONS", _LANDING):
            self._announce(cause, "Continuing Landing")
            return True
        return False

    def _is_landing(self) -> bool:
        behaviour = self.autopilot.behaviour
        return behaviour is not None and behaviour.landing

    def _should_disarm(self) -> bool:
        autopilot = self.autopilot
        if autopilot.now - autopilot.armed_at < _ARMING_DELAY:
            return True
        if autopilot.mode.number in _ZERO_THROTTLE_MODES:
            return autopilot.landed or autopilot.radio.sticks.throttle < _THROTTLE_CLOSED
        return autopilot.landed

    def _do(self, action: int, cause: str) -> None:
        if action == TERMINATE:
            self.disarm(cause)
        elif action != NONE:
            self._enter_first(action, cause)
        if action != NONE and self.option("FS_OPTIONS", _GRIPPER):
            self.autopilot.payload.grip(closed=False)

    def _enter_first(self, action: int, cause: str) -> None:
        """The mode of an action, or the next best one."""
        first = {
            SMART_RTL: (_MODE.SMART_RTL, "SmartRTL Unavailable, Trying RTL Mode", RTL),
            SMART_RTL_OR_LAND: (_MODE.SMART_RTL, "SmartRTL Unavailable, Using Land Mode", LAND),
            AUTO_RTL: (_MODE.AUTO_RTL, "Trying RTL Mode", RTL),
            BRAKE: (_MODE.BRAKE, "Trying Land Mode", LAND),
            RTL: (_MODE.RTL, "", LAND),
        }.get(action)
        if first is None:
            self.enter(_MODE.LAND, cause)
            return
        mode, text, second = first
        if not self.enter(mode, cause):
            if text:
                self.send_statustext(text)
            self._enter_first(second, cause)
