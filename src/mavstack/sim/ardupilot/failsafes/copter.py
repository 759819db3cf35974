"""Copter's failsafes: FS_THR_ENABLE, FS_GCS_ENABLE, BATT_FS_*_ACT, and FS_OPTIONS to continue; terrain.

A copter on the ground is disarmed. An action that is impossible falls back: SmartRTL to RTL or Land, RTL to
Land.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes
from mavstack.sim.autopilot.terrain import ABOVE_GROUND, knows_terrain

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.sim.ardupilot.failsafes.firmware import ModeFailure
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

_MODE: Final = ardupilotmega.CopterMode
#: Actions, with the numbers that BATT_FS_LOW_ACT has for them.
NONE, LAND, RTL, SMART_RTL, SMART_RTL_OR_LAND, TERMINATE, AUTO_RTL, BRAKE = range(8)
#: Actions by the value of FS_THR_ENABLE and of FS_GCS_ENABLE; unknown values mean LAND and RTL respectively.
_RADIO_ACTIONS: Final[Mapping[int, int]] = MappingProxyType(
    {0: NONE, 1: RTL, 2: RTL, 3: LAND, 4: SMART_RTL, 5: SMART_RTL_OR_LAND, 6: AUTO_RTL, 7: BRAKE}
)
_GROUND_ACTIONS: Final[Mapping[int, int]] = MappingProxyType(
    {0: NONE, 1: RTL, 2: RTL, 3: SMART_RTL, 4: SMART_RTL_OR_LAND, 5: LAND, 6: AUTO_RTL, 7: BRAKE}
)
#: Bit numbers of FS_OPTIONS.
_RADIO_IN_AUTO, _GROUND_IN_AUTO, _RADIO_IN_GUIDED, _LANDING, _GROUND_IN_MANUAL, _GRIPPER = range(6)
_THROTTLE_CLOSED: Final = 0.01
#: A failsafe within this many seconds after arming disarms instead of flying.
_ARMING_DELAY: Final = 2.0
#: Seconds without terrain data after which the terrain failsafe starts.
_TERRAIN_TIMEOUT: Final = 5.0
_ZERO_THROTTLE_MODES: Final = frozenset({_MODE.STABILIZE, _MODE.ACRO})


def should_disarm(autopilot: SimulatedAutopilot) -> bool:
    """Return whether a copter disarms instead of acting on a failsafe or avoiding an aircraft."""
    if autopilot.now - autopilot.armed_at < _ARMING_DELAY:
        return True
    if autopilot.mode.number in _ZERO_THROTTLE_MODES:
        return autopilot.landed or autopilot.radio.sticks.throttle < _THROTTLE_CLOSED
    return autopilot.landed


class CopterFailsafes(FirmwareFailsafes):
    """The failsafes of Copter."""

    battery_priorities = (TERMINATE, LAND, RTL, SMART_RTL_OR_LAND, SMART_RTL, NONE)

    def __init__(self, autopilot: SimulatedAutopilot, mode_failure: ModeFailure) -> None:
        super().__init__(autopilot, mode_failure)
        self._battery_lands = False
        self.add(
            "radio",
            lambda: self.radio_lost("FS_THR_ENABLE"),
            lambda: self.number("RC_FS_TIMEOUT"),
            self._on_radio_loss,
            lambda: self.send_statustext("Radio Failsafe Cleared"),
        )
        self.add(
            "ground",
            lambda: self.ground_lost("FS_GCS_ENABLE", "FS_GCS_TIMEOUT"),
            lambda: 0.0,
            self._on_ground_loss,
            lambda: self.send_statustext("GCS Failsafe Cleared"),
        )
        self.add("terrain", self._terrain_is_missing, lambda: _TERRAIN_TIMEOUT, self._on_terrain_loss)

    # Actions

    def _on_radio_loss(self) -> None:
        """Execute FS_THR_ENABLE."""
        action = _RADIO_ACTIONS.get(int(self.number("FS_THR_ENABLE")), LAND)
        mode = self.autopilot.mode.number
        if should_disarm(self.autopilot):
            self._announce("Radio", "Disarming")
            self.disarm("Radio")
        elif self._continues_landing("Radio", action):
            self._perform(LAND, "Radio")
        elif mode == _MODE.AUTO and self.option("FS_OPTIONS", _RADIO_IN_AUTO):
            self._announce("Radio", "Continuing Auto")
        elif mode == _MODE.GUIDED and self.option("FS_OPTIONS", _RADIO_IN_GUIDED):
            self._announce("Radio", "Continuing Guided Mode")
        else:
            self._announce("Radio")
            self._perform(action, "Radio")

    def _on_ground_loss(self) -> None:
        """Execute FS_GCS_ENABLE."""
        self.clear_overrides()
        action = _GROUND_ACTIONS.get(int(self.number("FS_GCS_ENABLE")), RTL)
        autopilot = self.autopilot
        if not autopilot.armed:
            self._announce("GCS")
        elif should_disarm(self.autopilot):
            self.disarm("GCS")
            self._announce("GCS", "Disarming")
        elif self._continues_landing("GCS", action):
            self._perform(LAND, "GCS")
        elif autopilot.mode.number == _MODE.AUTO and self.option("FS_OPTIONS", _GROUND_IN_AUTO):
            self._announce("GCS", "Continuing Auto Mode")
        elif autopilot.mode.manual_control and self.option("FS_OPTIONS", _GROUND_IN_MANUAL):
            self._announce("GCS", "Continuing Pilot Control")
        else:
            self._announce("GCS")
            self._perform(action, "GCS")

    def _terrain_is_missing(self) -> bool:
        """Return whether the mission counts from a terrain that the vehicle does not know."""
        autopilot = self.autopilot
        item = autopilot.mission.flown if autopilot.mode.number == _MODE.AUTO else None
        return (
            autopilot.armed
            and item is not None
            and item.frame in ABOVE_GROUND
            and not knows_terrain(autopilot)
        )

    def _on_terrain_loss(self) -> None:
        """Return to home."""
        self.send_statustext("Failsafe: Terrain data missing", common.MavSeverity.CRITICAL)
        if should_disarm(self.autopilot):
            self.disarm("Terrain")
        else:
            self._enter_first(RTL, "Terrain")

    def battery_failsafe(self, level: str, action: int) -> None:
        """Execute BATT_FS_LOW_ACT or BATT_FS_CRT_ACT."""
        self._battery_lands = action in (LAND, TERMINATE)
        if should_disarm(self.autopilot):
            self.disarm("Battery")
            self._announce("Battery", "Disarming")
        elif action != NONE and self._is_landing() and self.option("FS_OPTIONS", _LANDING):
            self._announce("Battery", "Continuing Landing")
            self._perform(LAND, "Battery")
        else:
            self._announce("Battery")
            self._perform(action, "Battery")

    # Helpers

    def _announce(self, cause: str, done: str = "") -> None:
        """Send the status text of a failsafe."""
        self.send_statustext(f"{cause} Failsafe - {done}" if done else f"{cause} Failsafe")

    def _continues_landing(self, cause: str, action: int) -> bool:
        """Return whether a running landing continues."""
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
        """Return whether the vehicle is landing."""
        behaviour = self.autopilot.behaviour
        return behaviour is not None and behaviour.landing

    def _perform(self, action: int, cause: str) -> None:
        """Execute an action."""
        if action == TERMINATE:
            self.disarm(cause)
        elif action != NONE:
            self._enter_first(action, cause)
        if action != NONE and self.option("FS_OPTIONS", _GRIPPER):
            self.autopilot.payload.grip(closed=False)

    def _enter_first(self, action: int, cause: str) -> None:
        """Enter the mode of an action, or its fallback."""
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
