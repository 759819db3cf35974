"""The texts for the problems that a vehicle can report."""

from __future__ import annotations

from typing import Final

from mavstack.dialects import ardupilotmega, common

_S: Final = common.MavSysStatusSensor
_X: Final = common.MavSysStatusSensorExtended
_E: Final = ardupilotmega.EkfStatusFlags
_F: Final = common.HlFailureFlag
_C: Final = common.MavBatteryChargeState

#: Sensor bits of SYS_STATUS.
SENSORS: Final = (
    (_S.SENSOR_3D_GYRO, "gyroscope"),
    (_S.SENSOR_3D_ACCEL, "accelerometer"),
    (_S.SENSOR_3D_MAG, "compass"),
    (_S.SENSOR_ABSOLUTE_PRESSURE, "barometer"),
    (_S.SENSOR_DIFFERENTIAL_PRESSURE, "airspeed sensor"),
    (_S.SENSOR_GPS, "GPS"),
    (_S.SENSOR_OPTICAL_FLOW, "optical flow sensor"),
    (_S.SENSOR_VISION_POSITION, "vision positioning"),
    (_S.SENSOR_LASER_POSITION, "rangefinder"),
    (_S.SENSOR_EXTERNAL_GROUND_TRUTH, "external positioning"),
    (_S.SENSOR_ANGULAR_RATE_CONTROL, "rate control"),
    (_S.SENSOR_ATTITUDE_STABILIZATION, "attitude control"),
    (_S.SENSOR_YAW_POSITION, "yaw control"),
    (_S.SENSOR_Z_ALTITUDE_CONTROL, "altitude control"),
    (_S.SENSOR_XY_POSITION_CONTROL, "position control"),
    (_S.SENSOR_MOTOR_OUTPUTS, "motor outputs"),
    (_S.SENSOR_RC_RECEIVER, "radio control receiver"),
    (_S.SENSOR_3D_GYRO2, "second gyroscope"),
    (_S.SENSOR_3D_ACCEL2, "second accelerometer"),
    (_S.SENSOR_3D_MAG2, "second compass"),
    (_S.GEOFENCE, "geofence"),
    (_S.AHRS, "attitude estimate"),
    (_S.TERRAIN, "terrain data"),
    (_S.REVERSE_MOTOR, "reversed motor"),
    (_S.LOGGING, "logging"),
    (_S.SENSOR_BATTERY, "battery"),
    (_S.SENSOR_PROXIMITY, "proximity sensor"),
    (_S.SENSOR_SATCOM, "satellite link"),
    (_S.OBSTACLE_AVOIDANCE, "obstacle avoidance"),
    (_S.SENSOR_PROPULSION, "propulsion"),
)
#: Extended sensor bits of SYS_STATUS.
EXTENDED_SENSORS: Final = (
    (_X.RECOVERY_SYSTEM, "parachute"),
    (_X.SENSOR_LEAK, "leak sensor"),
    (_X.SENSOR_3D_GYRO3, "third gyroscope"),
    (_X.SENSOR_3D_ACCEL3, "third accelerometer"),
    (_X.SENSOR_3D_GYRO4, "fourth gyroscope"),
    (_X.SENSOR_3D_ACCEL4, "fourth accelerometer"),
)
#: The estimates that a healthy estimator has: for each, at least one of its flags is set. The flags are the
#: same in EKF_STATUS_REPORT and ESTIMATOR_STATUS.
ESTIMATES: Final = (
    (_E.ATTITUDE, "attitude"),
    (_E.POS_HORIZ_ABS | _E.POS_HORIZ_REL, "horizontal position"),
    (_E.POS_VERT_ABS | _E.POS_VERT_AGL, "height"),
)
#: The test ratios of the estimator: the field in EKF_STATUS_REPORT, the field in ESTIMATOR_STATUS, and the
#: name.
RATIOS: Final = (
    ("velocity_variance", "vel_ratio", "velocity"),
    ("pos_horiz_variance", "pos_horiz_ratio", "horizontal position"),
    ("pos_vert_variance", "pos_vert_ratio", "height"),
    ("compass_variance", "mag_ratio", "compass"),
    ("airspeed_variance", "tas_ratio", "airspeed"),
)
#: Failure flags of HIGH_LATENCY2.
FAILURES: Final = (
    (_F.GPS, "GPS"),
    (_F.DIFFERENTIAL_PRESSURE, "airspeed sensor"),
    (_F.ABSOLUTE_PRESSURE, "barometer"),
    (_F["_3D_ACCEL"], "accelerometer"),
    (_F["_3D_GYRO"], "gyroscope"),
    (_F["_3D_MAG"], "compass"),
    (_F.TERRAIN, "terrain data"),
    (_F.BATTERY, "battery"),
    (_F.RC_RECEIVER, "radio control receiver"),
    (_F.OFFBOARD_LINK, "offboard link"),
    (_F.ENGINE, "engine"),
    (_F.GEOFENCE, "geofence"),
    (_F.ESTIMATOR, "estimator"),
    (_F.MISSION, "mission"),
)
#: Charge states of BATTERY_STATUS that are problems.
CHARGE_STATES: Final = (
    (_C.LOW, "is low"),
    (_C.CRITICAL, "is critically low"),
    (_C.EMERGENCY, "is almost empty"),
    (_C.FAILED, "has failed"),
    (_C.UNHEALTHY, "is unhealthy"),
)
#: States of HEARTBEAT in which a vehicle cannot be armed.
STATES: Final = (
    (common.MavState.BOOT, "it is starting"),
    (common.MavState.CALIBRATING, "it is calibrating"),
    (common.MavState.CRITICAL, "it is in a failsafe"),
    (common.MavState.EMERGENCY, "it is in an emergency"),
    (common.MavState.POWEROFF, "it is switching off"),
    (common.MavState.FLIGHT_TERMINATION, "its flight was terminated"),
)
