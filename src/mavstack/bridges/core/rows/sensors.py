"""Rows of sensors: pressures, temperatures, ranges, optical flow, wheels, receivers, terrain, vibration."""

from __future__ import annotations

from math import nan, pi
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.frames import frd_flu
from mavstack.bridges.core.qos import DEFAULT, NEWEST
from mavstack.bridges.core.row import Publication, Values, fields
from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from mavstack.bridges.core.view import VehicleView

_HECTOPASCAL: Final = 100.0
_ULTRASOUND, _INFRARED = 0, 1
_MAV_ULTRASOUND: Final = 1
_NAN_VECTOR: Final = (nan, nan, nan)
_DEFAULT_FIELD_OF_VIEW: Final = pi / 180 * 5
_RPM: Final = pi / 30


def static_pressure(message: Any, view: VehicleView) -> Values | None:
    """Return sensor_msgs/FluidPressure in pascal."""
    if isinstance(message, common.ScaledPressure):
        return None if view.latest(common.HighresImu) else (message.press_abs * _HECTOPASCAL, 0.0)
    return message.abs_pressure * _HECTOPASCAL, 0.0


def differential_pressure(message: Any, view: VehicleView) -> Values | None:
    """Return sensor_msgs/FluidPressure in pascal."""
    if isinstance(message, common.ScaledPressure):
        return None if view.latest(common.HighresImu) else (message.press_diff * _HECTOPASCAL, 0.0)
    return message.diff_pressure * _HECTOPASCAL, 0.0


def imu_temperature(message: Any, _view: VehicleView) -> Values | None:
    """Return sensor_msgs/Temperature in °C."""
    if isinstance(message, common.HighresImu):
        return message.temperature, 0.0
    return (message.temperature / 100, 0.0) if message.temperature else None  # 0: not known


def baro_temperature(message: Any, _view: VehicleView) -> Values:
    """Return sensor_msgs/Temperature in °C."""
    return message.temperature / 100, 0.0


def range_of(message: Any, _view: VehicleView) -> Values:
    """Return sensor_msgs/Range of a distance sensor, in metres."""
    if isinstance(message, ardupilotmega.Rangefinder):
        return _INFRARED, _DEFAULT_FIELD_OF_VIEW, 0.0, 1000.0, message.distance, 0.0
    kind = _ULTRASOUND if message.type == _MAV_ULTRASOUND else _INFRARED
    low, high = message.min_distance / 100, message.max_distance / 100
    variance = 0.0 if message.covariance == 0xFF else message.covariance * 1e-4
    view_angle = message.horizontal_fov or _DEFAULT_FIELD_OF_VIEW
    return kind, view_angle, low, high, message.current_distance / 100, variance


def flow(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/OpticalFlow."""
    return (
        *frd_flu(message.flow_x, message.flow_y, 0.0),
        *frd_flu(message.flow_comp_m_x, message.flow_comp_m_y, 0.0),
        message.quality,
        message.ground_distance,
        *frd_flu(message.flow_rate_x, message.flow_rate_y, 0.0),
    )


def flow_distance(message: Any, _view: VehicleView) -> Values:
    """Return sensor_msgs/Range of the sonar at a flow sensor."""
    distance = message.distance if isinstance(message, common.OpticalFlowRad) else message.ground_distance
    return _ULTRASOUND, 0.0, 0.3, 5.0, distance, 0.0


def flow_rad(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/OpticalFlowRad."""
    x, y, _ = frd_flu(message.integrated_x, message.integrated_y, 0.0)
    gyro = frd_flu(message.integrated_xgyro, message.integrated_ygyro, message.integrated_zgyro)
    return (
        *(message.integration_time_us, x, y, *gyro),
        *(message.temperature, message.quality, message.time_delta_distance_us, message.distance),
    )


def flow_temperature(message: Any, _view: VehicleView) -> Values:
    """Return sensor_msgs/Temperature in °C."""
    return message.temperature / 100, 0.0


def vibration(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/Vibration."""
    levels = message.vibration_x, message.vibration_y, message.vibration_z
    return *levels, message.clipping_0, message.clipping_1, message.clipping_2


def wheel_rpm(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/WheelOdomStamped in revolutions per minute."""
    return ((message.rpm1, message.rpm2),)


def wheel_distance(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/WheelOdomStamped in metres."""
    return (tuple(message.distance[: message.count]),)


def receiver(message: Any, view: VehicleView) -> Values:
    """Return mavros_msgs/GPSRAW."""
    corrections = (
        (message.dgps_numch, message.dgps_age) if isinstance(message, common.Gps2Raw) else (0xFF, 0xFFFFFFFF)
    )
    return (*(_RECEIVER(message, view) or ()), *corrections)


_RECEIVER: Final = fields(
    "fix_type",
    "lat",
    "lon",
    "alt",
    "eph",
    "epv",
    "vel",
    "cog",
    "satellites_visible",
    "alt_ellipsoid",
    "h_acc",
    "v_acc",
    "vel_acc",
    "hdg_acc",
    "yaw",
)
_RTK: Final = [
    "rtk_receiver_id",
    "wn",
    "tow",
    "rtk_health",
    "rtk_rate",
    "nsats",
    "baseline_a_mm",
    "baseline_b_mm",
    "baseline_c_mm",
    "accuracy",
    "iar_num_hypotheses",
]
_BASELINE: Final = [
    "time_last_baseline_ms",
    "rtk_receiver_id",
    "wn",
    "tow",
    "rtk_health",
    "rtk_rate",
    "nsats",
    "baseline_coords_type",
    "baseline_a_mm",
    "baseline_b_mm",
    "baseline_c_mm",
    "accuracy",
    "iar_num_hypotheses",
]


def terrain(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/TerrainReport."""
    heights = message.terrain_height, message.current_height
    return message.lat / 1e7, message.lon / 1e7, message.spacing, *heights, message.pending, message.loaded


_PRESSURES: Final = (common.HighresImu, common.ScaledPressure)

ROWS: Final = (
    Publication(
        "imu/static_pressure",
        "sensor_msgs/msg/FluidPressure",
        _PRESSURES,
        static_pressure,
        frame="base_link",
        meaning="Pa",
    ),
    Publication(
        "imu/diff_pressure",
        "sensor_msgs/msg/FluidPressure",
        _PRESSURES,
        differential_pressure,
        frame="base_link",
        meaning="Pa",
    ),
    Publication(
        "imu/temperature_imu",
        "sensor_msgs/msg/Temperature",
        (common.HighresImu, common.ScaledImu),
        imu_temperature,
        frame="base_link",
        meaning="°C",
    ),
    Publication(
        "imu/temperature_baro",
        "sensor_msgs/msg/Temperature",
        (common.ScaledPressure,),
        baro_temperature,
        frame="base_link",
        meaning="°C",
    ),
    Publication(
        "rangefinder/rangefinder",
        "sensor_msgs/msg/Range",
        (ardupilotmega.Rangefinder, common.DistanceSensor),
        range_of,
        DEFAULT,
        frame="base_link",
        meaning="m",
        difference="DISTANCE_SENSOR too, which MAVROS publishes by parameters only",
    ),
    Publication(
        "optical_flow/raw/optical_flow",
        "mavros_msgs/msg/OpticalFlow",
        (common.OpticalFlow,),
        flow,
        DEFAULT,
        frame="base_link",
        meaning="FLU",
    ),
    Publication(
        "optical_flow/ground_distance",
        "sensor_msgs/msg/Range",
        (common.OpticalFlow,),
        flow_distance,
        DEFAULT,
        frame="base_link",
        meaning="m",
    ),
    Publication(
        "px4flow/raw/optical_flow_rad",
        "mavros_msgs/msg/OpticalFlowRad",
        (common.OpticalFlowRad,),
        flow_rad,
        DEFAULT,
        frame="base_link",
        meaning="rad in FLU",
    ),
    Publication(
        "px4flow/ground_distance",
        "sensor_msgs/msg/Range",
        (common.OpticalFlowRad,),
        flow_distance,
        DEFAULT,
        frame="base_link",
        meaning="m",
    ),
    Publication(
        "px4flow/temperature",
        "sensor_msgs/msg/Temperature",
        (common.OpticalFlowRad,),
        flow_temperature,
        DEFAULT,
        frame="base_link",
        meaning="°C",
    ),
    Publication(
        "vibration/raw/vibration",
        "mavros_msgs/msg/Vibration",
        (common.Vibration,),
        vibration,
        DEFAULT,
        frame="base_link",
        meaning="m/s², counts",
    ),
    Publication(
        "wheel_odometry/rpm",
        "mavros_msgs/msg/WheelOdomStamped",
        (ardupilotmega.Rpm,),
        wheel_rpm,
        DEFAULT,
        meaning="1/min",
    ),
    Publication(
        "wheel_odometry/distance",
        "mavros_msgs/msg/WheelOdomStamped",
        (common.WheelDistance,),
        wheel_distance,
        DEFAULT,
        meaning="m",
    ),
    Publication("gpsstatus/gps1/raw", "mavros_msgs/msg/GPSRAW", (common.GpsRawInt,), receiver, DEFAULT),
    Publication("gpsstatus/gps2/raw", "mavros_msgs/msg/GPSRAW", (common.Gps2Raw,), receiver, DEFAULT),
    Publication("gpsstatus/gps1/rtk", "mavros_msgs/msg/GPSRTK", (common.GpsRtk,), fields(*_RTK), DEFAULT),
    Publication("gpsstatus/gps2/rtk", "mavros_msgs/msg/GPSRTK", (common.Gps2Rtk,), fields(*_RTK), DEFAULT),
    Publication(
        "gps_rtk/rtk_baseline",
        "mavros_msgs/msg/RTKBaseline",
        (common.GpsRtk,),
        fields(*_BASELINE),
        NEWEST,
    ),
    Publication(
        "terrain/report",
        "mavros_msgs/msg/TerrainReport",
        (common.TerrainReport,),
        terrain,
        DEFAULT,
        frame="base_link",
        meaning="degrees, m",
    ),
)
