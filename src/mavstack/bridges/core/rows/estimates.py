"""Rows of positions from outside: vision, motion capture, odometry, receivers, corrections, obstacles."""

from __future__ import annotations

from math import asin, atan2, degrees, isfinite, nan
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.frames import (
    flip_body,
    frd_flu,
    from_ros_attitude,
    ned_enu,
)
from mavstack.bridges.core.inbound import finite, location, quaternion, vector
from mavstack.bridges.core.qos import DEFAULT, NEWEST, SENSOR
from mavstack.bridges.core.row import Subscription
from mavstack.bridges.core.view import to_sea_level
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from mavstack.bridges.core.inbound import Inbound
    from mavstack.dialects import Message
    from mavstack.rotation import Quaternion

Fields = dict[str, Any]
_NO_COVARIANCE: Final = (nan, *[0.0] * 20)
_UNKNOWN_16: Final = 0xFFFF
_MAX_RANGES: Final = 72
_RTCM_SIZE: Final = 180
_RTCM_FRAGMENTS: Final = 4
_RTCM_SEQUENCES: Final = 32


def vision_position(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return VISION_POSITION_ESTIMATE from geometry_msgs/PoseStamped or PoseWithCovarianceStamped."""
    inbound.refuse_body_frame(fields)
    covariance = _NO_COVARIANCE
    pose = fields["pose"]
    if "covariance" in pose:
        covariance, pose = _triangle(pose["covariance"]), pose["pose"]
    x, y, z = ned_enu(*vector(pose["position"]))
    roll, pitch, yaw = angles_of(from_ros_attitude(*quaternion(pose["orientation"])))
    return (
        common.VisionPositionEstimate(
            usec=_microseconds(fields, inbound),
            x=x, y=y, z=z, roll=roll, pitch=pitch, yaw=yaw,
            covariance=covariance,
        ),
    )  # fmt: skip


def vision_speed(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return VISION_SPEED_ESTIMATE from a twist, with or without covariance, or from a vector."""
    inbound.refuse_body_frame(fields)
    covariance: Any = (nan, *[0.0] * 8)
    twist = fields.get("twist", {})
    if "covariance" in twist:
        block = [twist["covariance"][row * 6 + column] for row in range(3) for column in range(3)]
        covariance = _turned_block(block)
        twist = twist["twist"]
    x, y, z = ned_enu(*vector(twist["linear"] if twist else fields["vector"]))
    usec = _microseconds(fields, inbound)
    return (common.VisionSpeedEstimate(usec=usec, x=x, y=y, z=z, covariance=covariance),)


def _turned_block(block: list[float]) -> list[float]:
    """Return the 3x3 covariance in NED of one in ENU."""
    axes = ((1, 1.0), (0, 1.0), (2, -1.0))
    return [one * other * block[row * 3 + column] for row, one in axes for column, other in axes]


def mocap(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return ATT_POS_MOCAP from geometry_msgs/PoseStamped or TransformStamped."""
    inbound.refuse_body_frame(fields)
    if "transform" in fields:
        position, orientation = fields["transform"]["translation"], fields["transform"]["rotation"]
    else:
        position, orientation = fields["pose"]["position"], fields["pose"]["orientation"]
    x, y, z = ned_enu(*vector(position))
    q = from_ros_attitude(*quaternion(orientation))
    usec = _microseconds(fields, inbound)
    return (common.AttPosMocap(time_usec=usec, q=q, x=x, y=y, z=z, covariance=_NO_COVARIANCE),)


def odometry(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return ODOMETRY from nav_msgs/Odometry: the pose in ENU, the twist in FLU."""
    pose, twist = fields["pose"]["pose"], fields["twist"]["twist"]
    x, y, z = frd_flu(*vector(pose["position"]))
    qx, qy, qz, qw = quaternion(pose["orientation"])
    vx, vy, vz = frd_flu(*vector(twist["linear"]))
    roll, pitch, yaw = frd_flu(*vector(twist["angular"]))
    return (
        common.Odometry(
            time_usec=_microseconds(fields, inbound),
            frame_id=common.MavFrame.LOCAL_FRD,
            child_frame_id=common.MavFrame.BODY_FRD,
            x=x, y=y, z=z, q=flip_body(qw, qx, qy, qz), vx=vx, vy=vy, vz=vz,
            rollspeed=roll, pitchspeed=pitch, yawspeed=yaw,
            pose_covariance=_triangle(fields["pose"]["covariance"], body=True),
            velocity_covariance=_triangle(fields["twist"]["covariance"], body=True),
            estimator_type=common.MavEstimatorType.VISION,
        ),
    )  # fmt: skip


_ENU_AXES: Final = ((1, 1.0), (0, 1.0), (2, -1.0), (3, 1.0), (4, -1.0), (5, -1.0))
_BODY_AXES: Final = ((0, 1.0), (1, -1.0), (2, -1.0), (3, 1.0), (4, -1.0), (5, -1.0))


def _triangle(square: Any, *, body: bool = False) -> tuple[float, ...]:
    """Return the upper right triangle of a 6x6 covariance with the axes of MAVLink; NaN first if unknown."""
    if not any(square) or not all(map(isfinite, square)):
        return _NO_COVARIANCE
    axes = _BODY_AXES if body else _ENU_AXES
    return tuple(
        one * other * square[row * 6 + column]
        for index, (row, one) in enumerate(axes)
        for column, other in axes[index:]
    )


def angles_of(q: Quaternion) -> tuple[float, float, float]:
    """Return roll, pitch and yaw of a quaternion (w, x, y, z) in radians."""
    w, x, y, z = q
    roll = atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = asin(min(max(2 * (w * y - z * x), -1.0), 1.0))
    return roll, pitch, atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def _microseconds(fields: Fields, inbound: Inbound) -> int:
    """Return the time of a sample; the arrival time if the sample has no time."""
    stamp = fields["header"]["stamp"]
    return int(stamp["sec"] * 1_000_000 + stamp["nanosec"] // 1000) or inbound.microseconds


def origin(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return SET_GPS_GLOBAL_ORIGIN from geographic_msgs/GeoPointStamped, above the ellipsoid."""
    point = fields["position"]
    lat, lon = location(point["latitude"], point["longitude"])
    finite(point["altitude"])
    altitude = to_sea_level(point["latitude"], point["longitude"], point["altitude"])
    system = inbound.target.system
    return (
        common.SetGpsGlobalOrigin(
            target_system=system,
            latitude=lat,
            longitude=lon,
            altitude=round(altitude * 1000),
            time_usec=inbound.microseconds,
        ),
    )


def rtcm(fields: Fields, inbound: Inbound) -> tuple[Message, ...]:
    """Return GPS_RTCM_DATA in fragments from mavros_msgs/RTCM."""
    data = fields["data"]
    if len(data) > _RTCM_SIZE * _RTCM_FRAGMENTS:
        raise InvalidArgumentError(f"RTCM data must have at most 720 bytes, got {len(data)}")
    sequence = inbound.next_number("rtcm", _RTCM_SEQUENCES)
    count = len(data) // _RTCM_SIZE + 1 if len(data) > _RTCM_SIZE else 1
    parts = [data[start : start + _RTCM_SIZE] for start in range(0, count * _RTCM_SIZE, _RTCM_SIZE)]
    fragmented = int(len(parts) > 1)
    return tuple(
        common.GpsRtcmData(
            flags=fragmented | (number & 3) << 1 | sequence << 3,
            len=len(part),
            data=part.ljust(_RTCM_SIZE, b"\0"),
        )
        for number, part in enumerate(parts[:_RTCM_FRAGMENTS])
    )


def obstacles(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return OBSTACLE_DISTANCE from sensor_msgs/LaserScan in FLU, angles counter-clockwise."""
    finite(fields["angle_min"], fields["angle_increment"], fields["range_min"], fields["range_max"])
    ranges = fields["ranges"]
    if not ranges or fields["angle_increment"] <= 0:
        raise InvalidArgumentError("a scan must have ranges and a positive angle_increment")
    joined = -(-len(ranges) // _MAX_RANGES)
    # Angles in FRD increase clockwise, so the last range comes first.
    turned = ranges[::-1]
    nearest = [_nearest(turned[at : at + joined]) for at in range(0, len(turned), joined)]
    increment = degrees(fields["angle_increment"]) * joined
    last_angle = fields["angle_min"] + fields["angle_increment"] * (len(ranges) - 1)
    return (
        common.ObstacleDistance(
            time_usec=_microseconds(fields, inbound),
            sensor_type=common.MavDistanceSensor.LASER,
            distances=[*nearest, *[_UNKNOWN_16] * (_MAX_RANGES - len(nearest))],
            increment=min(max(round(increment), 0), 255),
            min_distance=_centimetres(fields["range_min"]),
            max_distance=_centimetres(fields["range_max"]),
            increment_f=increment,
            angle_offset=-degrees(last_angle),
            frame=common.MavFrame.BODY_FRD,
        ),
    )


def _nearest(ranges: Any) -> int:
    known = [value for value in ranges if isfinite(value) and value > 0]
    return min((_centimetres(value) for value in known), default=_UNKNOWN_16)


def _centimetres(metres: float) -> int:
    return min(max(round(metres * 100), 0), _UNKNOWN_16 - 1)


def gps_input(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return GPS_INPUT from mavros_msgs/GPSINPUT."""
    copied = {key: value for key, value in fields.items() if key != "header"}
    finite(*(value for value in copied.values() if isinstance(value, float)))
    return (common.GpsInput(time_usec=inbound.microseconds, **copied),)


def landing_target(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return LANDING_TARGET from mavros_msgs/LandingTarget, in the local frame."""
    pose = fields["pose"]
    x, y, z = ned_enu(*vector(pose["position"]))
    angle, size = fields["angle"], fields["size"]
    finite(*angle, *size, fields["distance"])
    return (
        common.LandingTarget(
            time_usec=_microseconds(fields, inbound),
            target_num=fields["target_num"],
            frame=common.MavFrame.LOCAL_NED,
            angle_x=angle[0], angle_y=angle[1], distance=fields["distance"],
            size_x=size[0], size_y=size[1],
            x=x, y=y, z=z, q=from_ros_attitude(*quaternion(pose["orientation"])),
            type=fields["type"], position_valid=1,
        ),
    )  # fmt: skip


_M: Final = "geometry_msgs/msg/"


def _row(
    name: str, kind: str, target: type[Message], receive: Any, qos: Any = DEFAULT, meaning: str = ""
) -> Subscription:
    return Subscription(name, kind, (target,), receive, qos, stream=True, meaning=meaning)


ROWS: Final = (
    _row(
        "vision_pose/pose",
        _M + "PoseStamped",
        common.VisionPositionEstimate,
        vision_position,
        meaning="m in ENU",
    ),
    _row(
        "vision_pose/pose_cov",
        _M + "PoseWithCovarianceStamped",
        common.VisionPositionEstimate,
        vision_position,
        meaning="m in ENU",
    ),
    _row("vision_speed/speed_twist", _M + "TwistStamped", common.VisionSpeedEstimate, vision_speed),
    _row(
        "vision_speed/speed_twist_cov",
        _M + "TwistWithCovarianceStamped",
        common.VisionSpeedEstimate,
        vision_speed,
        meaning="m/s in ENU",
    ),
    _row("vision_speed/speed_vector", _M + "Vector3Stamped", common.VisionSpeedEstimate, vision_speed),
    _row("mocap/pose", _M + "PoseStamped", common.AttPosMocap, mocap, NEWEST, "m in ENU"),
    _row("mocap/tf", _M + "TransformStamped", common.AttPosMocap, mocap, NEWEST, "m in ENU"),
    _row(
        "odometry/out",
        "nav_msgs/msg/Odometry",
        common.Odometry,
        odometry,
        NEWEST,
        "pose in ENU, twist in FLU",
    ),
    Subscription(
        "global_position/set_gp_origin",
        "geographic_msgs/msg/GeoPointStamped",
        (common.SetGpsGlobalOrigin,),
        origin,
        SENSOR,
        meaning="degrees, m above the ellipsoid",
    ),
    Subscription("gps_rtk/send_rtcm", "mavros_msgs/msg/RTCM", (common.GpsRtcmData,), rtcm, DEFAULT),
    _row(
        "obstacle/send",
        "sensor_msgs/msg/LaserScan",
        common.ObstacleDistance,
        obstacles,
        meaning="m, counter-clockwise in FLU",
    ),
    _row("gps_input/gps_input", "mavros_msgs/msg/GPSINPUT", common.GpsInput, gps_input, NEWEST),
    _row(
        "landing_target/raw",
        "mavros_msgs/msg/LandingTarget",
        common.LandingTarget,
        landing_target,
        meaning="m in ENU",
    ),
)
