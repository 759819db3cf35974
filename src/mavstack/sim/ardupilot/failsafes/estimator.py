"""Failsafe of the position estimate: ten bad checks in a row trigger it, ten good ones clear it.

The estimate is checked on every tick of 0.1 s. It is bad without a position or heading, or if two of compass,
velocity and position exceed FS_EKF_THRESH. Copter then lands or holds its altitude (FS_EKF_ACTION), Rover
holds, a quadplane in hover lands; all only in modes that need a position. A lost or contradicting GPS is
reported.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega
from mavstack.sim.ardupilot.failsafes.firmware import CRITICAL
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.ardupilot.failsafes.firmware import FirmwareFailsafes

_COPTER, _ROVER, _PLANE = ardupilotmega.CopterMode, ardupilotmega.RoverMode, ardupilotmega.PlaneMode
_MAX_COUNT: Final = 10
_WARNING_INTERVAL: Final = 30.0
#: Values of FS_EKF_ACTION. Copter: 1 lands, 2 enters ALT_HOLD, 3 lands even in Stabilize. Rover: 0 does
#: nothing, 1 enters HOLD, 2 only reports.
_ALT_HOLD, _LAND_ALWAYS = 2, 3
_ROVER_NOTHING, _ROVER_HOLD = 0, 1
_GATE: Final = 1.0


class EstimatorCheck:
    """Checks the estimate; one of the autopilot's periodic checks."""

    def __init__(self, firmware: FirmwareFailsafes) -> None:
        self._firmware = firmware
        self._autopilot = firmware.autopilot
        self._bad_count = 0
        self._was_good = self._glitching = self._acted = False
        self._warned_at = float("-inf")
        self._autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Check the estimate, and act."""
        self._check_glitches()
        if self._firmware.number("FS_EKF_THRESH") <= 0:
            self._bad_count = 0
            self._clear()
            return
        bad = self._is_bad()
        self._was_good = self._was_good or (not bad and self._autopilot.home is not None)
        if not self._was_good or not self._is_checked():
            return
        self._bad_count = min(self._bad_count + 1, _MAX_COUNT) if bad else max(self._bad_count - 1, 0)
        if self._bad_count == _MAX_COUNT and not self._is_active:
            self._fail(now)
        elif self._bad_count == 0:
            self._clear()

    def _check_glitches(self) -> None:
        """Report the start and end of a glitch."""
        health = self._autopilot.body.health
        glitching = self._autopilot.home is not None and (
            health.position_variance >= _GATE or not health.heading
        )
        if glitching != self._glitching:
            self._glitching = glitching
            if self._autopilot.vehicle.vehicle_type is VehicleType.COPTER:
                self._firmware.send_statustext(
                    "GPS Glitch or Compass error" if glitching else "Glitch cleared", CRITICAL
                )

    # Conditions

    @property
    def _is_active(self) -> bool:
        """True while the failsafe is active."""
        return "estimate" in self._autopilot.failsafes

    def _is_checked(self) -> bool:
        """Return whether to check: always on Copter, armed on Rover, in hover on Plane."""
        autopilot = self._autopilot
        if autopilot.vehicle.vehicle_type is VehicleType.VTOL:
            return autopilot.armed and not autopilot.maneuvers.circles
        return autopilot.armed or autopilot.vehicle.vehicle_type is VehicleType.COPTER

    def _is_bad(self) -> bool:
        """Return whether the estimate is bad."""
        health, limit = self._autopilot.body.health, self._firmware.number("FS_EKF_THRESH")
        if not (health.horizontal and health.heading):
            return True
        over = int(health.compass_variance >= limit) + int(health.velocity_variance >= limit)
        over += int(health.velocity_variance >= 2 * limit)
        return over >= 2 or (over >= 1 and health.position_variance >= limit)

    # Actions

    def _fail(self, now: float) -> None:
        """Trigger the failsafe."""
        self._autopilot.failsafes.add("estimate")
        if now - self._warned_at > _WARNING_INTERVAL:
            self._warned_at = now
            self._firmware.send_statustext("EKF variance", CRITICAL)
        if self._autopilot.armed:
            self._acted = self._act()

    def _clear(self) -> None:
        """Clear the failsafe."""
        if self._is_active:
            self._autopilot.failsafes.discard("estimate")
            rover = self._autopilot.vehicle.vehicle_type.on_surface
            if self._acted or rover:
                self._firmware.send_statustext(
                    "EKF failsafe cleared" if rover else "EKF Failsafe Cleared", CRITICAL
                )
            self._acted = False

    def _act(self) -> bool:
        """Execute the action of the vehicle type; return whether anything was done."""
        vehicle_type = self._autopilot.vehicle.vehicle_type
        if vehicle_type.on_surface:
            return self._act_rover()
        return self._act_copter() if vehicle_type is VehicleType.COPTER else self._act_quadplane()

    def _act_copter(self) -> bool:
        """Land or hold altitude."""
        autopilot, firmware = self._autopilot, self._firmware
        action = firmware.number("FS_EKF_ACTION")
        if autopilot.mode.number == _COPTER.LAND:
            return False
        if not autopilot.mode.needs_position and action != _LAND_ALWAYS:
            return False
        manual_control = action == _ALT_HOLD and "radio" not in autopilot.failsafes
        if not (manual_control and firmware.enter(_COPTER.ALT_HOLD, "EKF")):
            firmware.enter(_COPTER.LAND, "EKF")
        firmware.send_statustext(f"EKF Failsafe: changed to {autopilot.mode.name} Mode", CRITICAL)
        return True

    def _act_quadplane(self) -> bool:
        """Hover or land."""
        autopilot, firmware = self._autopilot, self._firmware
        if autopilot.mode.needs_position or autopilot.mode.number == _PLANE.GUIDED:
            target_mode = _PLANE.QHOVER if autopilot.radio.present else _PLANE.QLAND
            firmware.enter(target_mode, "EKF")
        return True

    def _act_rover(self) -> bool:
        """Hold, or only report."""
        action = self._firmware.number("FS_EKF_ACTION")
        if not self._autopilot.mode.needs_position or action == _ROVER_NOTHING:
            return False
        if action == _ROVER_HOLD:
            self._firmware.enter(_ROVER.HOLD, "EKF")
        self._firmware.send_statustext("EKF failsafe", CRITICAL)
        return True
