"""Rows of setpoints: they steer the vehicle in its guided or offboard mode."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.frames import frd_flu, from_ros_attitude, ned_enu, ned_to_enu_yaw
from mavstack.bridges.core.inbound import MAX_AGE, finite, location, quaternion, vector, yaw_of
from mavstack.bridges.core.qos import DEFAULT, SENSOR
from mavstack.bridges.core.row import Subscription
from mavstack.bridges.core.view import to_sea_level
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.setpoints import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint

if TYPE_CHECKING:
    from mavstack.bridges.core.inbound import Inbound
    from mavstack.bridges.core.qos import Qos
    from mavstack.bridges.core.row import Receiver
    from mavstack.dialects import Message

Fields = dict[str, Any]
_FRAME: Final = common.MavFrame
_MASK: Final = common.AttitudeTargetTypemask
_BODY_FRAMES: Final = (_FRAME.BODY_NED, _FRAME.BODY_OFFSET_NED, _FRAME.BODY_FRD)


def _send(setpoint: LocalSetpoint | GlobalSetpoint | AttitudeSetpoint, inbound: Inbound) -> tuple[Message]:
    return (setpoint.to_message(inbound.target, inbound.boot_milliseconds),)


def local_position(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return a position in the local frame from geometry_msgs/PoseStamped."""
    inbound.refuse_body_frame(fields)
    pose = fields["pose"]
    yaw = ned_to_enu_yaw(yaw_of(quaternion(pose["orientation"])))
    return _send(LocalSetpoint(position=ned_enu(*vector(pose["position"])), yaw=yaw), inbound)


def global_position(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return a global position from geographic_msgs/GeoPoseStamped, above the ellipsoid."""
    point = fields["pose"]["position"]
    latitude, longitude, height = point["latitude"], point["longitude"], point["altitude"]
    location(latitude, longitude)
    finite(height)
    altitude = to_sea_level(latitude, longitude, height)
    yaw = ned_to_enu_yaw(yaw_of(quaternion(fields["pose"]["orientation"])))
    return _send(GlobalSetpoint(latitude, longitude, altitude, yaw=yaw, frame=_FRAME.GLOBAL), inbound)


def velocity(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return a velocity from geometry_msgs/TwistStamped, in ENU or in the frame of the body."""
    return _velocity(fields["twist"], inbound, body=inbound.is_body_frame(fields))


def velocity_unstamped(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return a velocity from geometry_msgs/Twist in ENU."""
    return _velocity(fields, inbound, body=False)


def _velocity(twist: Fields, inbound: Inbound, *, body: bool) -> tuple[Message]:
    linear, angular = vector(twist["linear"]), vector(twist["angular"])
    axes = frd_flu(*linear) if body else ned_enu(*linear)
    frame = _FRAME.BODY_NED if body else _FRAME.LOCAL_NED
    return _send(LocalSetpoint(velocity=axes, yaw_rate=-angular[2], frame=frame), inbound)


def acceleration(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return an acceleration from geometry_msgs/Vector3Stamped in ENU."""
    inbound.refuse_body_frame(fields)
    return _send(LocalSetpoint(acceleration=ned_enu(*vector(fields["vector"]))), inbound)


def raw_local(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return a setpoint from mavros_msgs/PositionTarget; its mask and frame are kept."""
    body = fields["coordinate_frame"] in _BODY_FRAMES
    convert = frd_flu if body else ned_enu
    x, y, z = _masked(fields["position"])
    position, turned = convert(x, y, z), -fields["yaw"] if body else ned_to_enu_yaw(_number(fields["yaw"]))
    sent = common.SetPositionTargetLocalNed(
        time_boot_ms=inbound.boot_milliseconds,
        target_system=inbound.target.system,
        target_component=inbound.target.component,
        coordinate_frame=fields["coordinate_frame"],
        type_mask=fields["type_mask"],
        x=position[0],
        y=position[1],
        z=position[2],
        **_motion(fields, convert),
        yaw=turned,
        yaw_rate=-fields["yaw_rate"],
    )
    LocalSetpoint.read(sent)  # raises SetpointError
    return (sent,)


def raw_global(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return a setpoint from mavros_msgs/GlobalPositionTarget; its mask and frame are kept."""
    lat, lon = location(_number(fields["latitude"]), _number(fields["longitude"]))
    sent = common.SetPositionTargetGlobalInt(
        time_boot_ms=inbound.boot_milliseconds,
        target_system=inbound.target.system,
        target_component=inbound.target.component,
        coordinate_frame=fields["coordinate_frame"],
        type_mask=fields["type_mask"],
        lat_int=lat,
        lon_int=lon,
        alt=fields["altitude"],
        **_motion(fields, ned_enu),
        yaw=ned_to_enu_yaw(_number(fields["yaw"])),
        yaw_rate=-fields["yaw_rate"],
    )
    GlobalSetpoint.read(sent)
    return (sent,)


def _motion(fields: Fields, convert: Any) -> Fields:
    velocity = convert(*_masked(fields["velocity"]))
    acceleration = convert(*_masked(fields["acceleration_or_force"]))
    names = ("vx", "vy", "vz", "afx", "afy", "afz")
    return dict(zip(names, (*velocity, *acceleration), strict=True))


def _masked(fields: Fields) -> tuple[float, float, float]:
    """Return x, y, z of a vector whose axes may be ignored by the mask."""
    return fields["x"], fields["y"], fields["z"]


def _number(value: float) -> float:
    """Return a value that the mask may ignore: publishers write NaN into those."""
    return value if value - value == 0.0 else 0.0


def raw_attitude(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return a setpoint from mavros_msgs/AttitudeTarget; its mask is kept."""
    mask = fields["type_mask"]
    ignored = bool(mask & _MASK.ATTITUDE_IGNORE)
    q = (0.0, 0.0, 0.0, 1.0) if ignored else quaternion(fields["orientation"])
    roll, pitch, yaw = frd_flu(*_masked(fields["body_rate"]))
    sent = common.SetAttitudeTarget(
        time_boot_ms=inbound.boot_milliseconds,
        target_system=inbound.target.system,
        target_component=inbound.target.component,
        type_mask=mask & ~int(_MASK.THRUST_BODY_SET),
        q=from_ros_attitude(*q),
        body_roll_rate=roll,
        body_pitch_rate=pitch,
        body_yaw_rate=yaw,
        thrust=fields["thrust"],
    )
    AttitudeSetpoint.read(sent)
    return (sent,)


def thrust(fields: Fields, inbound: Inbound) -> tuple[()]:
    """Take mavros_msgs/Thrust in, for the attitudes that follow."""
    finite(fields["thrust"])
    inbound.thrust = fields["thrust"], inbound.now
    return ()


def attitude(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return an attitude from geometry_msgs/PoseStamped, with the last thrust."""
    q = from_ros_attitude(*quaternion(fields["pose"]["orientation"]))
    return _send(AttitudeSetpoint(q, thrust=_fresh_thrust(inbound)), inbound)


def rates(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return body rates from geometry_msgs/TwistStamped, with the last thrust."""
    angular = frd_flu(*vector(fields["twist"]["angular"]))
    return _send(AttitudeSetpoint(rates=angular, thrust=_fresh_thrust(inbound)), inbound)


def _fresh_thrust(inbound: Inbound) -> float:
    if inbound.thrust is None or inbound.now - inbound.thrust[1] > MAX_AGE:
        raise InvalidArgumentError("setpoint_attitude/thrust must be published too, within 0.5 s")
    return inbound.thrust[0]


def trajectory(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return the first point of a trajectory_msgs/MultiDOFJointTrajectory."""
    inbound.refuse_body_frame(fields)
    points = fields["points"]
    if not points or not points[0]["transforms"]:
        raise InvalidArgumentError("a trajectory must have a point with a transform")
    first = points[0]
    transform = first["transforms"][0]
    position = ned_enu(*vector(transform["translation"]))
    yaw = ned_to_enu_yaw(yaw_of(quaternion(transform["rotation"])))
    speeds = [ned_enu(*vector(each[0]["linear"])) for each in (first["velocities"],) if each]
    setpoint = LocalSetpoint(position=position, yaw=yaw)
    if speeds:
        setpoint = LocalSetpoint(position=position, velocity=speeds[0], yaw=yaw)
    return _send(setpoint, inbound)


_LOCAL: Final = (common.SetPositionTargetLocalNed,)
_GLOBAL: Final = (common.SetPositionTargetGlobalInt,)
_ATTITUDE: Final = (common.SetAttitudeTarget,)


def _row(
    name: str,
    kind: str,
    targets: tuple[type[Message], ...],
    receive: Receiver,
    qos: Qos = SENSOR,
    meaning: str = "",
    difference: str = "",
) -> Subscription:
    return Subscription(
        name, kind, targets, receive, qos, stream=True, meaning=meaning, difference=difference
    )


ROWS: Final = (
    _row(
        "setpoint_position/local",
        "geometry_msgs/msg/PoseStamped",
        _LOCAL,
        local_position,
        meaning="m in ENU, yaw",
    ),
    _row(
        "setpoint_position/global",
        "geographic_msgs/msg/GeoPoseStamped",
        _GLOBAL,
        global_position,
        meaning="degrees, m above the ellipsoid, yaw",
    ),
    _row(
        "setpoint_velocity/cmd_vel",
        "geometry_msgs/msg/TwistStamped",
        _LOCAL,
        velocity,
        meaning="m/s in ENU, or in FLU if frame_id is base_link; yaw rate",
        difference="the frame is that of the header; MAVROS takes it from a parameter",
    ),
    _row(
        "setpoint_velocity/cmd_vel_unstamped",
        "geometry_msgs/msg/Twist",
        _LOCAL,
        velocity_unstamped,
        meaning="m/s in ENU, yaw rate",
    ),
    _row(
        "setpoint_accel/accel",
        "geometry_msgs/msg/Vector3Stamped",
        _LOCAL,
        acceleration,
        meaning="m/s² in ENU",
    ),
    _row(
        "setpoint_raw/local",
        "mavros_msgs/msg/PositionTarget",
        _LOCAL,
        raw_local,
        meaning="ENU, or FLU in body frames; the mask is kept",
    ),
    _row(
        "setpoint_raw/global",
        "mavros_msgs/msg/GlobalPositionTarget",
        _GLOBAL,
        raw_global,
        meaning="degrees, m in the given frame; the mask is kept",
    ),
    _row(
        "setpoint_raw/attitude",
        "mavros_msgs/msg/AttitudeTarget",
        _ATTITUDE,
        raw_attitude,
        meaning="orientation in ENU; the mask is kept",
    ),
    _row(
        "setpoint_attitude/attitude",
        "geometry_msgs/msg/PoseStamped",
        _ATTITUDE,
        attitude,
        DEFAULT,
        "orientation in ENU",
    ),
    _row(
        "setpoint_attitude/cmd_vel",
        "geometry_msgs/msg/TwistStamped",
        _ATTITUDE,
        rates,
        DEFAULT,
        "rad/s in FLU",
    ),
    _row("setpoint_attitude/thrust", "mavros_msgs/msg/Thrust", (), thrust, DEFAULT, "0 to 1"),
    _row(
        "setpoint_trajectory/local",
        "trajectory_msgs/msg/MultiDOFJointTrajectory",
        _LOCAL,
        trajectory,
        meaning="m in ENU",
        difference="only the first point is sent; publish the next one when it is due",
    ),
)
