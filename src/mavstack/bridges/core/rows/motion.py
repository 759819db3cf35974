"""Rows of the motion: attitude and inertial sensors, local position, odometry, wind, speeds."""

from __future__ import annotations

from math import cos, radians, sin
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.frames import (
    conjugate,
    flip_body,
    frd_flu,
    ned_enu,
    ros_attitude_of,
    rotate,
    to_ros_attitude,
)
from mavstack.bridges.core.qos import DEFAULT
from mavstack.bridges.core.row import Publication, Values
from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from mavstack.bridges.core.view import VehicleView

_GRAVITY: Final = 9.80665
_UNKNOWN_3: Final = (-1.0, *[0.0] * 8)
_ZEROS: Final = (0.0,) * 36
_UNKNOWN_6: Final = (-1.0, *[0.0] * 35)
_FRAME: Final = common.MavFrame
_IMUS: Final = (common.HighresImu, common.ScaledImu, common.RawImu)


def acceleration(message: Any) -> tuple[float, float, float] | None:
    """Return the acceleration of an inertial sensor in FLU, m/s²; None if it has no unit."""
    if type(message) is common.HighresImu:
        return message.xacc, -message.yacc, -message.zacc
    if isinstance(message, common.ScaledImu | common.RawImu):
        factor = _GRAVITY / 1000
        return frd_flu(message.xacc * factor, message.yacc * factor, message.zacc * factor)
    return None


def _gyro(message: Any) -> tuple[float, float, float]:
    factor = 1.0 if isinstance(message, common.HighresImu) else 1e-3
    return frd_flu(message.xgyro * factor, message.ygyro * factor, message.zgyro * factor)


def _latest_imu(view: VehicleView) -> Any:
    for kind in _IMUS:
        found = view.latest(kind)
        if found is not None:
            return found
    return None


def imu(message: Any, view: VehicleView) -> Values | None:
    """Return sensor_msgs/Imu: attitude of the estimator, rates, and the last acceleration measured."""
    if type(message) is common.Attitude:
        if view.latest(common.AttitudeQuaternion) is not None:
            return None
        attitude = ros_attitude_of(message.roll, message.pitch, message.yaw)
    else:
        attitude = to_ros_attitude(message.q1, message.q2, message.q3, message.q4)
    measured = acceleration(_latest_imu(view))
    noise = view.noise
    return (
        *attitude,
        *noise.orientation,
        message.rollspeed,
        -message.pitchspeed,
        -message.yawspeed,
        *noise.rate,
        *(measured or (0.0, 0.0, 0.0)),
        *(noise.acceleration if measured else _UNKNOWN_3),
    )


def imu_raw(message: Any, view: VehicleView) -> Values | None:
    """Return sensor_msgs/Imu without an orientation, of the best sensor message that the vehicle sends."""
    if not _is_best_imu(message, view):
        return None
    measured = acceleration(message)
    noise = view.noise
    return (
        *(0.0, 0.0, 0.0, 0.0),
        *_UNKNOWN_3,
        *_gyro(message),
        *noise.rate,
        *(measured or (0.0, 0.0, 0.0)),
        *(noise.acceleration if measured else _UNKNOWN_3),
    )


def _is_best_imu(message: Any, view: VehicleView) -> bool:
    better = _IMUS[: _IMUS.index(type(message))] if type(message) in _IMUS else ()
    return all(view.latest(kind) is None for kind in better)


def magnetic_field(message: Any, view: VehicleView) -> Values | None:
    """Return sensor_msgs/MagneticField in tesla."""
    if not _is_best_imu(message, view):
        return None
    factor = 1e-4 if isinstance(message, common.HighresImu) else 1e-7
    field = frd_flu(message.xmag * factor, message.ymag * factor, message.zmag * factor)
    return *field, *_UNKNOWN_3


def pose(message: Any, view: VehicleView) -> Values:
    """Return geometry_msgs/PoseStamped of the local position."""
    return *ned_enu(message.x, message.y, message.z), *view.attitude()


def velocity_local(message: Any, view: VehicleView) -> Values:
    """Return geometry_msgs/TwistStamped in the map frame."""
    linear = ned_enu(message.vx, message.vy, message.vz)
    return *linear, *rotate(view.attitude(), view.rates())


def velocity_body(message: Any, view: VehicleView) -> Values:
    """Return geometry_msgs/TwistStamped in the frame of the body."""
    linear = ned_enu(message.vx, message.vy, message.vz)
    return *rotate(conjugate(view.attitude()), linear), *view.rates()


def odometry(message: Any, view: VehicleView) -> Values:
    """Return nav_msgs/Odometry of the local position."""
    covariances = _covariances(message)
    return (
        view.frames.base_link,
        *pose(message, view),
        *covariances[0],
        *velocity_body(message, view),
        *covariances[1],
    )


def _covariances(message: Any) -> tuple[Values, Values]:
    if not isinstance(message, common.LocalPositionNedCov):
        return _ZEROS, _ZEROS
    known = message.covariance  # upper right triangle: position, velocity and acceleration
    return _on_diagonal(known[9], known[0], known[17]), _on_diagonal(known[30], known[24], known[35])


def _on_diagonal(x: float, y: float, z: float) -> tuple[float, ...]:
    full = list(_ZEROS)
    full[0], full[7], full[14] = x, y, z
    return tuple(full)


def pose_covariance(message: Any, view: VehicleView) -> Values:
    """Return geometry_msgs/PoseWithCovarianceStamped."""
    return *pose(message, view), *_covariances(message)[0]


def velocity_covariance(message: Any, view: VehicleView) -> Values:
    """Return geometry_msgs/TwistWithCovarianceStamped in the frame of the body."""
    return *velocity_body(message, view), *_covariances(message)[1]


def acceleration_covariance(message: Any, _view: VehicleView) -> Values:
    """Return geometry_msgs/AccelWithCovarianceStamped."""
    known = message.covariance
    linear = ned_enu(message.ax, message.ay, message.az)
    return *linear, 0.0, 0.0, 0.0, *_on_diagonal(known[42], known[39], known[44])


def odometry_in(message: Any, view: VehicleView) -> Values | None:
    """Return nav_msgs/Odometry of ODOMETRY; None for frames that have no meaning in ROS."""
    if message.frame_id in (_FRAME.LOCAL_NED, _FRAME.LOCAL_FRD):
        position = ned_enu(message.x, message.y, message.z)
        attitude = to_ros_attitude(*message.q)
    elif message.frame_id == _FRAME.LOCAL_FLU:
        position = (message.x, message.y, message.z)
        w, x, y, z = flip_body(*message.q)
        attitude = (x, y, z, w)
    else:
        return None
    linear, angular = (
        (message.vx, message.vy, message.vz),
        (
            message.rollspeed,
            message.pitchspeed,
            message.yawspeed,
        ),
    )
    return (
        view.frames.base_link,
        *position,
        *attitude,
        *_square(message.pose_covariance, enu=True),
        *frd_flu(*linear),
        *frd_flu(*angular),
        *_square(message.velocity_covariance, enu=False),
    )


def _square(triangle: Values, *, enu: bool) -> Values:
    """Return a 6x6 covariance from its upper right triangle, with the axes of ROS."""
    if triangle[0] != triangle[0]:  # NaN: not known
        return _UNKNOWN_6
    axes = ((1, 1), (0, 1), (2, -1), (3, 1), (4, -1), (5, -1)) if enu else _BODY_AXES
    rows = []
    for first, one in axes:
        for second, other in axes:
            low, high = sorted((first, second))
            rows.append(one * other * triangle[low * 6 - low * (low - 1) // 2 + high - low])
    return rows


_BODY_AXES: Final = ((0, 1), (1, -1), (2, -1), (3, 1), (4, -1), (5, -1))


def wind(message: Any, _view: VehicleView) -> Values:
    """Return geometry_msgs/TwistWithCovarianceStamped: where the wind blows to."""
    if isinstance(message, ardupilotmega.Wind):
        course = radians(message.direction + 180.0)
        linear = (message.speed * sin(course), message.speed * cos(course), -message.speed_z)
        return *linear, 0.0, 0.0, 0.0, *_UNKNOWN_6
    covariance = _on_diagonal(message.var_horiz, 0.0, message.var_vert)
    return *ned_enu(message.wind_x, message.wind_y, message.wind_z), 0.0, 0.0, 0.0, *covariance


def vfr_hud(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/VfrHud, with the throttle from 0 to 1."""
    speeds = (message.airspeed, message.groundspeed)
    return *speeds, message.heading, message.throttle / 100, message.alt, message.climb


def attitude_target(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/AttitudeTarget."""
    rates = frd_flu(message.body_roll_rate, message.body_pitch_rate, message.body_yaw_rate)
    return message.type_mask, *to_ros_attitude(*message.q), *rates, message.thrust


_ATTITUDES: Final = (common.Attitude, common.AttitudeQuaternion)
_LOCAL: Final = (common.LocalPositionNed,)
_COVARIANT: Final = (common.LocalPositionNedCov,)
_TWIST: Final = "geometry_msgs/msg/TwistStamped"

ROWS: Final = (
    Publication(
        "imu/data",
        "sensor_msgs/msg/Imu",
        _ATTITUDES,
        imu,
        frame="base_link",
        meaning="rad/s, m/s² in FLU; orientation in ENU",
    ),
    Publication(
        "imu/data_raw",
        "sensor_msgs/msg/Imu",
        _IMUS,
        imu_raw,
        frame="base_link",
        meaning="rad/s, m/s² in FLU; no orientation",
    ),
    Publication(
        "imu/mag",
        "sensor_msgs/msg/MagneticField",
        _IMUS,
        magnetic_field,
        frame="base_link",
        meaning="T in FLU",
    ),
    Publication(
        "local_position/pose", "geometry_msgs/msg/PoseStamped", _LOCAL, pose, frame="map", meaning="m in ENU"
    ),
    Publication(
        "local_position/pose_cov",
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        _COVARIANT,
        pose_covariance,
        frame="map",
        meaning="m in ENU",
    ),
    Publication(
        "local_position/odom",
        "nav_msgs/msg/Odometry",
        _LOCAL,
        odometry,
        frame="map",
        meaning="m in ENU, twist in FLU",
    ),
    Publication(
        "local_position/velocity_local",
        _TWIST,
        _LOCAL,
        velocity_local,
        frame="map",
        meaning="m/s, rad/s in ENU",
        difference="frame_id is map, the frame of the values; MAVROS says base_link",
    ),
    Publication(
        "local_position/velocity_body",
        _TWIST,
        _LOCAL,
        velocity_body,
        frame="base_link",
        meaning="m/s, rad/s in FLU",
    ),
    Publication(
        "local_position/velocity_body_cov",
        "geometry_msgs/msg/TwistWithCovarianceStamped",
        _COVARIANT,
        velocity_covariance,
        frame="base_link",
        meaning="m/s, rad/s in FLU",
    ),
    Publication(
        "local_position/accel",
        "geometry_msgs/msg/AccelWithCovarianceStamped",
        _COVARIANT,
        acceleration_covariance,
        frame="map",
        meaning="m/s² in ENU",
    ),
    Publication(
        "odometry/in",
        "nav_msgs/msg/Odometry",
        (common.Odometry,),
        odometry_in,
        DEFAULT,
        frame="odom",
        meaning="m in ENU, twist in FLU",
    ),
    Publication(
        "wind_estimation",
        "geometry_msgs/msg/TwistWithCovarianceStamped",
        (ardupilotmega.Wind, common.WindCov),
        wind,
        meaning="m/s in ENU, where the wind blows to",
    ),
    Publication(
        "vfr_hud",
        "mavros_msgs/msg/VfrHud",
        (common.VfrHud,),
        vfr_hud,
        DEFAULT,
        meaning="m/s, degrees, throttle 0 to 1",
    ),
    Publication(
        "setpoint_raw/target_attitude",
        "mavros_msgs/msg/AttitudeTarget",
        (common.AttitudeTarget,),
        attitude_target,
        meaning="orientation in ENU",
    ),
)
