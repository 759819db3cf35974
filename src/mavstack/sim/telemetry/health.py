"""SYS_STATUS masks of sensors: present, enabled and healthy, as each firmware reports them.

The bits are plain integers for speed, because masks are combined for each message.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.sim.autopilot.terrain import knows_terrain
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.telemetry.view import VehicleView

_BIT = common.MavSysStatusSensor
_IMU = int(_BIT.SENSOR_3D_GYRO | _BIT.SENSOR_3D_ACCEL)
_COMPASS, _BAROMETER = int(_BIT.SENSOR_3D_MAG), int(_BIT.SENSOR_ABSOLUTE_PRESSURE)
_AIRSPEED, _GPS = int(_BIT.SENSOR_DIFFERENTIAL_PRESSURE), int(_BIT.SENSOR_GPS)
_MOTORS, _BATTERY = int(_BIT.SENSOR_MOTOR_OUTPUTS), int(_BIT.SENSOR_BATTERY)
_RADIO = int(_BIT.SENSOR_RC_RECEIVER)
_LOGGING, _PREARM = int(_BIT.LOGGING), int(_BIT.PREARM_CHECK)
_FENCE, _AHRS, _TERRAIN = int(_BIT.GEOFENCE), int(_BIT.AHRS), int(_BIT.TERRAIN)
_ATTITUDE = int(_BIT.SENSOR_ATTITUDE_STABILIZATION)
_CONTROL = int(_BIT.SENSOR_ANGULAR_RATE_CONTROL | _BIT.SENSOR_YAW_POSITION) | _ATTITUDE
_POSITION = int(_BIT.SENSOR_Z_ALTITUDE_CONTROL | _BIT.SENSOR_XY_POSITION_CONTROL)
#: Sensor bits that every vehicle reports.
_ON_EVERY_VEHICLE = _IMU | _COMPASS | _BAROMETER | _GPS | _MOTORS | _LOGGING | _BATTERY | _RADIO | _PREARM
_FIX_3D = 3
#: Test ratio above which the compass is unhealthy.
_GATE = 1.0
#: The battery is unhealthy while a failsafe is active whose name begins with this word.
_BATTERY_FAILSAFE = "battery"


class SensorMasks(NamedTuple):
    """The three masks of SYS_STATUS."""

    present: int
    enabled: int
    health: int


class SensorHealth:
    """SYS_STATUS masks of one vehicle."""

    def __init__(self, view: VehicleView) -> None:
        self._view = view
        self._fitted = _ON_EVERY_VEHICLE | _AIRSPEED if view.winged else _ON_EVERY_VEHICLE
        self._ardupilot = self._fitted | _CONTROL | _POSITION | _AHRS | _FENCE
        if view.vehicle.vehicle_type is not VehicleType.SUB:
            self._ardupilot |= _TERRAIN

    def ardupilot(self) -> SensorMasks:
        """Return ArduPilot's masks: position control is enabled in modes that hold a position."""
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
        faults = self._faults()
        if not view.health.attitude or not autopilot.booted:
            faults |= _AHRS
        if not knows_terrain(autopilot):
            faults |= _TERRAIN
        return SensorMasks(present, enabled, present & ~faults)

    def px4(self) -> SensorMasks:
        """Return PX4's masks: an absent sensor is healthy unless a check reports it."""
        radio = self._view.autopilot.radio.present
        present = self._fitted & ~_PREARM
        if not radio:
            present &= ~_RADIO
        enabled = present | _RADIO
        health = present | _AIRSPEED | _ATTITUDE | _AHRS | _PREARM
        return SensorMasks(present, enabled, health & ~self._faults())

    def _faults(self) -> int:
        """Return the unhealthy sensors that both firmwares detect in the same way."""
        view = self._view
        body, autopilot = view.body, view.autopilot
        faults = 0
        if view.sensors.gps_fix < _FIX_3D:
            faults |= _GPS
        if view.health.compass_variance > _GATE:
            faults |= _COMPASS
        if not autopilot.radio.present:
            faults |= _RADIO
        if not view.ready:
            faults |= _PREARM
        if (
            any(name.startswith(_BATTERY_FAILSAFE) for name in autopilot.failsafes)
            or not body.battery.remaining > 0
        ):
            faults |= _BATTERY
        if autopilot.terminated:
            faults |= _MOTORS
        return faults
