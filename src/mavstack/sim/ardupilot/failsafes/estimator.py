"""The check of the position estimate: ten bad looks in a row, a second, are a failsafe; ten good ones end it.

It is bad without a position or a heading, or if two of compass, velocity and position fit their sensors too
badly (FS_EKF_THRESH). Copter then lands or holds its altitude (FS_EKF_ACTION), Rover holds, a quadplane in
hover lands; all of them only in modes that need a position. GPS that is lost, or contradicts the estimate, is
told.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega
from mavstack.sim.ardupilot.failsafes.firmware import CRITICAL
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes

_COPTER, _ROVER, _PLANE = ardupilotmega.CopterMode, ardupilotmega.RoverMode, ardupilotmega.PlaneMode
_LOOKS: Final = 10
_WARN_AGAIN: Final = 30.0
#: FS_EKF_ACTION of Copter: land, ALT_HOLD, land even in Stabilize; of Rover: nothing, hold, report.
_ALT_HOLD, _LAND_EVEN_BY_HAND = 2, 3
_ROVER_NOTHING, _ROVER_HOLD = 0, 1
_GATE: Final = 1.0


class EstimatorCheck:
    """One of its autopilot's watches."""

    def __init__(self, firmware: FirmwareFailsafes) -> None:
        self._firmware = firmware
        self._autopilot = firmware.autopilot
        self._bad_looks = 0
        self._has_passed = self._glitching = self._acted = False
        self._warned_at = float("-inf")
        self._autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Look, and act."""
        self._look_for_glitches()
        if self._firmware.number("FS_EKF_THRESH") <= 0:
            self._bad_looks = 0
            self._clear()
            return
        bad = self._is_bad()
        self._has_passed = self._has_passed or (not bad and self._autopilot.home is not None)
        if not self._has_passed or not self._is_watched():
            return
        self._bad_looks = min(self._bad_looks + 1, _LOOKS) if bad else max(self._bad_looks - 1, 0)
        if self._bad_looks == _LOOKS and not self._is_active:
            self._fail(now)
        elif self._bad_looks == 0:
            self._clear()

    def _look_for_glitches(self) -> None:
        health = self._autopilot.body.health
        glitching = self._autopilot.home is not None and (
            health.position_variance >= _GATE or not health.heading
        )
        if glitching != self._glitching:
            self._glitching = glitching
            if self._autopilot.vehicle.type is VehicleType.COPTER:
                self._firmware.send_statustext(
                    "GPS Glitch or Compass error" if glitching else "Glitch cleared", CRITICAL
                )

    # What is bad

    @property
    def _is_active(self) -> bool:
        return "estimate" in self._autopilot.failsafes

    def _is_watched(self) -> bool:
        """Copter always looks, Rover while it is armed, Plane while it hovers."""
        autopilot = self._autopilot
        if autopilot.vehicle.type is VehicleType.VTOL:
            return autopilot.armed and not autopilot.maneuvers.circles
        return autopilot.armed or autopilot.vehicle.type is VehicleType.COPTER

    def _is_bad(self) -> bool:
        health, limit = self._autopilot.body.health, self._firmware.number("FS_EKF_THRESH")
        if not (health.horizontal and health.heading):
            return True
        over = int(health.compass_variance >= limit) + int(health.velocity_variance >= limit)
        over += int(health.velocity_variance >= 2 * limit)
        return over >= 2 or (over >= 1 and health.position_variance >= limit)

    # What is done

    def _fail(self, now: float) -> None:
        self._autopilot.failsafes.add("estimate")
        if now - self._warned_at > _WARN_AGAIN:
            self._warned_at = now
            self._firmware.send_statustext("EKF variance", CRITICAL)
        if self._autopilot.armed:
            self._acted = self._act()

    def _clear(self) -> None:
        if self._is_active:
            self._autopilot.failsafes.discard("estimate")
            rover = self._autopilot.vehicle.type.on_surface
            if self._acted or rover:
                self._firmware.send_statustext(
                    "EKF failsafe cleared" if rover else "EKF Failsafe Cleared", CRITICAL
                )
            self._acted = False

    def _act(self) -> bool:
        kind = self._autopilot.vehicle.type
        if kind.on_surface:
            return self._rover()
        return self._copter() if kind is VehicleType.COPTER else self._quadplane()

    def _copter(self) -> bool:
        autopilot, firmware = self._autopilot, self._firmware
        action = firmware.number("FS_EKF_ACTION")
        if autopilot.mode.number == _COPTER.LAND:
            return False
        if not autopilot.mode.needs_position and action != _LAND_EVEN_BY_HAND:
            return False
        manual_control = action == _ALT_HOLD and "radio" not in autopilot.failsafes
        if not (manual_control and firmware.enter(_COPTER.ALT_HOLD, "EKF")):
            firmware.enter(_COPTER.LAND, "EKF")
        firmware.send_statustext(f"EKF Failsafe: changed to {autopilot.mode.name} Mode", CRITICAL)
        return True

    def _quadplane(self) -> bool:
        autopilot, firmware = self._autopilot, self._firmware
        if autopilot.mode.needs_position or autopilot.mode.number == _PLANE.GUIDED:
            wanted = _PLANE.QHOVER if autopilot.radio.present else _PLANE.QLAND
            firmware.enter(wanted, "EKF")
        return True

    def _rover(self) -> bool:
        action = self._firmware.number("FS_EKF_ACTION")
        if not self._autopilot.mode.needs_position or action == _ROVER_NOTHING:
            return False
        if action == _ROVER_HOLD:
            self._firmware.enter(_ROVER.HOLD, "EKF")
        self._firmware.send_statustext("EKF failsafe", CRITICAL)
        return True
