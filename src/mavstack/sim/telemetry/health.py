"""What is fitted, in use and in order, as the masks of SYS_STATUS say it for each firmware.

The bits are plain numbers, since masks are put together for each message.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.telemetry.view import View

_BIT = common.MavSysStatusSensor
_IMU = int(_BIT.SENSOR_3D_GYRO | _BIT.SENSOR_3D_ACCEL)
_COMPASS, _BAROMETER = int(_BIT.SENSOR_3D_MAG), int(_BIT.SENSOR_ABSOLUTE_PRESSURE)
_AIR, _GPS = int(_BIT.SENSOR_DIFFERENTIAL_PRESSURE), int(_BIT.SENSOR_GPS)
_MOTORS, _BATTERY = int(_BIT.SENSOR_MOTOR_OUTPUTS), int(_BIT.SENSOR_BATTERY)
_RADIO = int(_BIT.SENSOR_RC_RECEIVER)
_LOGGING, _PREARM = int(_BIT.LOGGING), int(_BIT.PREARM_CHECK)
_FENCE, _AHRS, _TERRAIN = int(_BIT.GEOFENCE), int(_BIT.AHRS), int(_BIT.TERRAIN)
_ATTITUDE = int(_BIT.SENSOR_ATTITUDE_STABILIZATION)
_CONTROL = int(_BIT.SENSOR_ANGULAR_RATE_CONTROL | _BIT.SENSOR_YAW_POSITION) | _ATTITUDE
_POSITION = int(_BIT.SENSOR_Z_ALTITUDE_CONTROL | _BIT.SENSOR_XY_POSITION_CONTROL)
#: What every vehicle has.
_ALWAYS = _IMU | _COMPASS | _BAROMETER | _GPS | _MOTORS | _LOGGING | _BATTERY | _RADIO | _PREARM
_FIX_3D = 3
#: Beyond this the compass does not fit the rest.
_GATE = 1.0
#: A failsafe whose name begins with this makes the battery unhealthy.
_BATTERY_FAILSAFE = "battery"


class Masks(NamedTuple):
    """The three masks."""

    present: int
    enabled: int
    health: int


class Health:
    """The masks of one vehicle."""

    def __init__(self, view: View) -> None:
        self._view = view
        self._fitted = _ALWAYS | _AIR if view.winged else _ALWAYS
        self._ardupilot = self._fitted | _CONTROL | _POSITION | _AHRS | _FENCE
        if view.vehicle.type is not VehicleType.SUB:
            self._ardupilot |= _TERRAIN

    def ardupilot(self) -> Masks:
        """As ArduPilot reports: position control is enabled in modes that hold a position."""
        view = self._view
        autopilot = view.autopilot
        present = self._ardupilot
        enabled = present & ~(_POSITION | _FENCE)
        if autopilot.mode.needs_position:
            enabled |= _POSITION
        if view.parameter("FENCE_ENABLE", 0) > 0:
            enabled |= _FENCE
        if view.parameter("BATT_MONITOR", 4) <= 0:
            present &= ~_BATTERY
            enabled &= ~_BATTERY
        wrong = self._wrong()
        if not view.health.attitude or not autopilot.booted:
            wrong |= _AHRS
        return Masks(present, enabled, present & ~wrong)

    def px4(self) -> Masks:
        """As PX4 reports: what is not present is healthy unless something complains about it."""
        radio = self._view.autopilot.radio.present
        present = self._fitted & ~_PREARM
        if not radio:
            present &= ~_RADIO
        enabled = present | _RADIO
        health = present | _AIR | _ATTITUDE | _AHRS | _PREARM
        return Masks(present, enabled, health & ~self._wrong())

    def _wrong(self) -> int:
        """What both firmwares find out in the same way."""
        view = self._view
        body, autopilot = view.body, view.autopilot
        wrong = 0
        if view.sensors.gps_fix < _FIX_3D:
            wrong |= _GPS
        if view.health.compass_variance > _GATE:
            wrong |= _COMPASS
        if not autopilot.radio.present:
            wrong |= _RADIO
        if not view.ready:
            wrong |= _PREARM
        if (
            any(name.startswith(_BATTERY_FAILSAFE) for name in autopilot.failsafes)
            or not body.battery.remaining > 0
        ):
            wrong |= _BATTERY
        if autopilot.terminated:
            wrong |= _MOTORS
        return wrong
