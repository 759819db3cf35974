"""Sub's failsafes: FS_GCS_ENABLE, FS_PILOT_INPUT and FS_EKF_ACTION, with repeated warnings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega
from mavstack.sim.ardupilot.failsafes.firmware import CRITICAL, FirmwareFailsafes
from mavstack.sim.autopilot.failsafes import ground_silence

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import ModeFailure
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

_MODE: Final = ardupilotmega.SubMode
#: Values of FS_GCS_ENABLE; FS_PILOT_INPUT and FS_EKF_ACTION use 1 and 2 with the same meaning.
_WARN, _DISARM, _HOLD, _SURFACE = 1, 2, 3, 4
#: Values of BATT_FS_LOW_ACT.
_BATTERY_DISARM, _BATTERY_SURFACE = 2, 3
_WARNING_INTERVAL: Final = 30.0
_EKF_TIME: Final = 2.0


class SubFailsafes(FirmwareFailsafes):
    """The failsafes of Sub; one of the autopilot's periodic checks."""

    battery_priorities = (_BATTERY_DISARM, _BATTERY_SURFACE, _WARN, 0)

    def __init__(self, autopilot: SimulatedAutopilot, mode_failure: ModeFailure) -> None:
        super().__init__(autopilot, mode_failure)
        self._warned_at = float("-inf")
        self.add(
            "ground",
            lambda: autopilot.armed and self.ground_lost("FS_GCS_ENABLE", "FS_GCS_TIMEOUT"),
            lambda: 0.0,
            self._on_ground_loss,
        )
        self.add(
            "radio",
            lambda: autopilot.armed and self.radio_lost("FS_PILOT_INPUT"),
            lambda: self.number("FS_PILOT_TIMEOUT"),
            self._on_pilot_loss,
        )
        self.add("estimate", self._estimate_is_bad, lambda: _EKF_TIME, self._on_bad_estimate)
        autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Warn repeatedly while the ground station is silent."""
        if not self.number("FS_GCS_ENABLE") or now - self._warned_at <= _WARNING_INTERVAL:
            return
        silence = ground_silence(self.autopilot)
        if silence is not None and silence > self.number("FS_GCS_TIMEOUT"):
            self._warned_at = now
            self.send_statustext(f"MYGCS: {self.number('SYSID_MYGCS'):.0f}, heartbeat lost")

    def _on_ground_loss(self) -> None:
        """Execute FS_GCS_ENABLE."""
        action = int(self.number("FS_GCS_ENABLE"))
        target_mode = {_HOLD: _MODE.ALT_HOLD, _SURFACE: _MODE.SURFACE}.get(action)
        if action == _DISARM or (target_mode is not None and not self.enter(target_mode, "GCS")):
            self.disarm("GCS")

    def _on_pilot_loss(self) -> None:
        """Execute FS_PILOT_INPUT."""
        self.send_statustext("Lost manual control", CRITICAL)
        if self.number("FS_PILOT_INPUT") == _DISARM:
            self.disarm("Pilot input")

    def _estimate_is_bad(self) -> bool:
        """Return whether the estimate is bad."""
        if not self.number("FS_EKF_ACTION"):
            return False
        health, limit = self.autopilot.body.health, self.number("FS_EKF_THRESH")
        return health.compass_variance >= limit or health.velocity_variance >= limit

    def _on_bad_estimate(self) -> None:
        """Execute FS_EKF_ACTION."""
        self.send_statustext("EKF bad")
        if self.number("FS_EKF_ACTION") == _DISARM:
            self.disarm("EKF")

    def battery_failsafe(self, level: str, action: int) -> None:
        """Execute BATT_FS_LOW_ACT or BATT_FS_CRT_ACT."""
        if action == _BATTERY_DISARM:
            self.disarm("Battery")
        elif action == _BATTERY_SURFACE:
            self.enter(_MODE.SURFACE, "Battery")
