"""Sub's failsafes: FS_GCS_ENABLE, FS_PILOT_INPUT and FS_EKF_ACTION; warnings repeat while it lasts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega
from mavstack.sim.ardupilot.failsafes.firmware import CRITICAL, FirmwareFailsafes
from mavstack.sim.autopilot.failsafes import ground_silence

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import ModeFailure
    from mavstack.sim.autopilot.interfaces import Autopilot

_MODE: Final = ardupilotmega.SubMode
#: FS_GCS_ENABLE; FS_PILOT_INPUT, FS_EKF_ACTION and the battery's actions know the first three, too.
_WARN, _DISARM, _HOLD, _SURFACE = 1, 2, 3, 4
#: BATT_FS_LOW_ACT.
_BATTERY_DISARM, _BATTERY_SURFACE = 2, 3
_WARN_AGAIN: Final = 30.0
_EKF_PATIENCE: Final = 2.0


class SubFailsafes(FirmwareFailsafes):
    """As Sub has them; one of its autopilot's watches."""

    battery_priorities = (_BATTERY_DISARM, _BATTERY_SURFACE, _WARN, 0)

    def __init__(self, autopilot: Autopilot, mode_failure: ModeFailure) -> None:
        super().__init__(autopilot, mode_failure)
        self._warned_at = float("-inf")
        self.watch(
            "ground",
            lambda: autopilot.armed and self.ground_lost("FS_GCS_ENABLE", "FS_GCS_TIMEOUT"),
            lambda: 0.0,
            self._ground,
        )
        self.watch(
            "radio",
            lambda: autopilot.armed and self.radio_lost("FS_PILOT_INPUT"),
            lambda: self.number("FS_PILOT_TIMEOUT"),
            self._pilot,
        )
        self.watch("estimate", self._estimate_is_bad, lambda: _EKF_PATIENCE, self._estimate)
        autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Warn while the ground station is silent."""
        if not self.number("FS_GCS_ENABLE") or now - self._warned_at <= _WARN_AGAIN:
            return
        silence = ground_silence(self.autopilot)
        if silence is not None and silence > self.number("FS_GCS_TIMEOUT"):
            self._warned_at = now
            self.send_statustext(f"MYGCS: {self.number('SYSID_MYGCS'):.0f}, heartbeat lost")

    def _ground(self) -> None:
        action = int(self.number("FS_GCS_ENABLE"))
        wanted = {_HOLD: _MODE.ALT_HOLD, _SURFACE: _MODE.SURFACE}.get(action)
        if action == _DISARM or (wanted is not None and not self.enter(wanted, "GCS")):
            self.disarm("GCS")

    def _pilot(self) -> None:
        self.send_statustext("Lost manual control", CRITICAL)
        if self.number("FS_PILOT_INPUT") == _DISARM:
            self.disarm("Pilot input")

    def _estimate_is_bad(self) -> bool:
        if not self.number("FS_EKF_ACTION"):
            return False
        health, limit = self.autopilot.body.health, self.number("FS_EKF_THRESH")
        return health.compass_variance >= limit or health.velocity_variance >= limit

    def _estimate(self) -> None:
        self.send_statustext("EKF bad")
        if self.number("FS_EKF_ACTION") == _DISARM:
            self.disarm("EKF")

    def battery_failsafe(self, word: str, action: int) -> None:
        """BATT_FS_LOW_ACT, BATT_FS_CRT_ACT."""
        if action == _BATTERY_DISARM:
            self.disarm("Battery")
        elif action == _BATTERY_SURFACE:
            self.enter(_MODE.SURFACE, "Battery")
