"""Rows of the global position: GNSS, the fused position, altitudes, origin, home, targets."""

from __future__ import annotations

from math import cos, nan, radians, sin
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.frames import ned_enu, ned_to_enu_yaw, to_ros_attitude
from mavstack.bridges.core.qos import DEFAULT, LATCHED, STATE
from mavstack.bridges.core.row import Publication, Values, fields
from mavstack.bridges.core.view import to_ellipsoid
from mavstack.dialects import common
from mavstack.geodesy import LocalFrame

if TYPE_CHECKING:
    from mavstack.bridges.core.view import VehicleView

_UNKNOWN_16: Final = 0xFFFF
_FIX_2D: Final = 2
_NO_FIX, _FIX = -1, 0
_GPS: Final = 1
_COVARIANCE_UNKNOWN, _APPROXIMATED, _DIAGONAL = 0, 1, 2
_ROTATION_DEVIATION: Final = 99999.0
_TARGET_FRAME: Final = common.MavFrame


def _degrees(message: Any) -> tuple[float, float]:
    return message.lat / 1e7, message.lon / 1e7


def raw_fix(message: Any, view: VehicleView) -> Values:
    """Return sensor_msgs/NavSatFix of a receiver; the height is from the vehicle if it sends a height."""
    latitude, longitude = _degrees(message)
    # An ellipsoid height of exactly 0 mm does not occur: the message then lacks its extension fields.
    height = message.alt_ellipsoid / 1e3 or to_ellipsoid(latitude, longitude, message.alt / 1e3)
    return (*_fix_status(message), latitude, longitude, height, *_fix_covariance(message, view))


def _fix_status(message: Any) -> tuple[int, int]:
    return (_FIX if message.fix_type > _FIX_2D else _NO_FIX), _GPS


def _fix_covariance(message: Any, view: VehicleView) -> Values:
    """Return the nine covariances and their type."""
    if message.h_acc > 0 and message.v_acc > 0:
        horizontal, vertical = (message.h_acc / 1e3) ** 2, (message.v_acc / 1e3) ** 2
        return horizontal, 0.0, 0.0, 0.0, horizontal, 0.0, 0.0, 0.0, vertical, _DIAGONAL
    if _UNKNOWN_16 in (message.eph, message.epv):
        return *(-1.0, *[0.0] * 8), _COVARIANCE_UNKNOWN
    uere = view.noise.uere
    horizontal, vertical = (message.eph / 100 * uere) ** 2, (message.epv / 100 * uere) ** 2
    return horizontal, 0.0, 0.0, 0.0, horizontal, 0.0, 0.0, 0.0, vertical, _APPROXIMATED


def raw_velocity(message: Any, _view: VehicleView) -> Values | None:
    """Return geometry_msgs/TwistStamped of a receiver's speed and course."""
    if _UNKNOWN_16 in (message.vel, message.cog):
        return None
    speed, course = message.vel / 100, radians(message.cog / 100)
    return speed * sin(course), speed * cos(course), 0.0, 0.0, 0.0, 0.0


def satellites(message: Any, _view: VehicleView) -> Values:
    """Return std_msgs/UInt32."""
    return (message.satellites_visible,)


def global_fix(message: Any, view: VehicleView) -> Values:
    """Return sensor_msgs/NavSatFix of the estimator, with status and covariance of the receiver."""
    latitude, longitude = _degrees(message)
    receiver = view.latest(common.GpsRawInt)
    height = to_ellipsoid(latitude, longitude, message.alt / 1e3)
    if receiver is None:
        unknown = (-1.0, *[0.0] * 8)
        return _FIX, _GPS, latitude, longitude, height, *unknown, _COVARIANCE_UNKNOWN
    covariance = _fix_covariance(receiver, view)
    return (*_fix_status(receiver), latitude, longitude, height, *covariance)


def relative_altitude(message: Any, _view: VehicleView) -> Values:
    """Return std_msgs/Float64 in metres above home."""
    return (message.relative_alt / 1e3,)


def heading(message: Any, _view: VehicleView) -> Values:
    """Return std_msgs/Float64 in degrees."""
    return (nan if message.hdg == _UNKNOWN_16 else message.hdg / 100,)


def global_odometry(message: Any, view: VehicleView) -> Values:
    """Return nav_msgs/Odometry: the global position in ENU around the origin."""
    latitude, longitude = _degrees(message)
    view.set_first_fix(latitude, longitude, message.alt / 1e3)
    origin = view.origin() or (latitude, longitude, message.alt / 1e3)
    north, east, _ = LocalFrame(*origin).to_local(latitude, longitude, message.alt / 1e3)
    receiver = view.latest(common.GpsRawInt)
    known = _fix_covariance(receiver, view) if receiver is not None else (-1.0, *[0.0] * 8)
    covariance = [0.0] * 36
    covariance[0], covariance[7], covariance[14] = known[0], known[4], known[8]
    covariance[21] = covariance[28] = covariance[35] = _ROTATION_DEVIATION
    velocity = ned_enu(message.vx / 100, message.vy / 100, message.vz / 100)
    return (
        view.frames.base_link,
        *(east, north, message.relative_alt / 1e3),
        *view.attitude(),
        *covariance,
        *velocity,
        *(0.0, 0.0, 0.0),
        *(-1.0, *[0.0] * 35),
    )


def origin(message: Any, _view: VehicleView) -> Values:
    """Return geographic_msgs/GeoPointStamped, with the height above the ellipsoid."""
    return _geo_point(message)


def _geo_point(message: Any) -> tuple[float, float, float]:
    latitude, longitude = message.latitude / 1e7, message.longitude / 1e7
    return latitude, longitude, to_ellipsoid(latitude, longitude, message.altitude / 1e3)


def home(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/HomePosition."""
    return (
        *_geo_point(message),
        *ned_enu(message.x, message.y, message.z),
        *to_ros_attitude(*message.q),
        *ned_enu(message.approach_x, message.approach_y, message.approach_z),
    )


def local_target(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/PositionTarget."""
    return (
        message.coordinate_frame,
        message.type_mask,
        *ned_enu(message.x, message.y, message.z),
        *ned_enu(message.vx, message.vy, message.vz),
        *ned_enu(message.afx, message.afy, message.afz),
        ned_to_enu_yaw(message.yaw),
        -message.yaw_rate,
    )


def global_target(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/GlobalPositionTarget."""
    return (
        message.coordinate_frame,
        message.type_mask,
        message.lat_int / 1e7,
        message.lon_int / 1e7,
        message.alt,
        *ned_enu(message.vx, message.vy, message.vz),
        *ned_enu(message.afx, message.afy, message.afz),
        ned_to_enu_yaw(message.yaw),
        -message.yaw_rate,
    )


_GNSS: Final = (common.GpsRawInt,)
_FUSED: Final = (common.GlobalPositionInt,)
_ALTITUDES: Final = [
    "altitude_monotonic",
    "altitude_amsl",
    "altitude_local",
    "altitude_relative",
    "altitude_terrain",
    "bottom_clearance",
]

ROWS: Final = (
    Publication(
        "global_position/raw/fix",
        "sensor_msgs/msg/NavSatFix",
        _GNSS,
        raw_fix,
        frame="base_link",
        meaning="degrees, m above the ellipsoid",
        difference="the height above the ellipsoid is the receiver's own where the vehicle sends it",
    ),
    Publication(
        "global_position/raw/gps_vel",
        "geometry_msgs/msg/TwistStamped",
        _GNSS,
        raw_velocity,
        frame="map",
        meaning="m/s in ENU",
    ),
    Publication("global_position/raw/satellites", "std_msgs/msg/UInt32", _GNSS, satellites),
    Publication(
        "global_position/global",
        "sensor_msgs/msg/NavSatFix",
        _FUSED,
        global_fix,
        frame="base_link",
        meaning="degrees, m above the ellipsoid",
    ),
    Publication(
        "global_position/local",
        "nav_msgs/msg/Odometry",
        _FUSED,
        global_odometry,
        frame="map",
        meaning="m in ENU around the origin",
        difference="the vertical speed is positive upwards; MAVROS leaves it downwards",
    ),
    Publication(
        "global_position/rel_alt", "std_msgs/msg/Float64", _FUSED, relative_altitude, meaning="m above home"
    ),
    Publication("global_position/compass_hdg", "std_msgs/msg/Float64", _FUSED, heading, meaning="degrees"),
    Publication(
        "global_position/gp_origin",
        "geographic_msgs/msg/GeoPointStamped",
        (common.GpsGlobalOrigin,),
        origin,
        LATCHED,
        frame="earth",
        meaning="degrees, m above the ellipsoid",
    ),
    Publication(
        "home_position/home",
        "mavros_msgs/msg/HomePosition",
        (common.HomePosition,),
        home,
        STATE,
        meaning="degrees, m above the ellipsoid; m in ENU",
    ),
    Publication(
        "altitude",
        "mavros_msgs/msg/Altitude",
        (common.Altitude,),
        fields(*_ALTITUDES),
        frame="map",
        meaning="m",
    ),
    Publication(
        "setpoint_raw/target_local",
        "mavros_msgs/msg/PositionTarget",
        (common.PositionTargetLocalNed,),
        local_target,
        meaning="m in ENU",
    ),
    Publication(
        "setpoint_raw/target_global",
        "mavros_msgs/msg/GlobalPositionTarget",
        (common.PositionTargetGlobalInt,),
        global_target,
        meaning="degrees, m; vectors in ENU",
    ),
    Publication(
        "nav_controller_output/output",
        "mavros_msgs/msg/NavControllerOutput",
        (common.NavControllerOutput,),
        fields(
            *[
                "nav_roll",
                "nav_pitch",
                "nav_bearing",
                "target_bearing",
                "wp_dist",
                "alt_error",
                "aspd_error",
                "xtrack_error",
            ]
        ),
        DEFAULT,
        meaning="degrees, m, m/s",
    ),
)
