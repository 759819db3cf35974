"""The transforms of a vehicle: where its body is in the map, and the axes of MAVLink beside those of ROS."""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.frames import ned_enu
from mavstack.bridges.core.qos import LATCHED, Qos
from mavstack.bridges.core.row import Publication, Values
from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.bridges.core.view import VehicleView

_HALF: Final = sqrt(0.5)
#: The rotations of NED in ENU, and of FRD in FLU, as quaternions (x, y, z, w).
_NED_IN_ENU: Final = (_HALF, _HALF, 0.0, 0.0)
_FRD_IN_FLU: Final = (1.0, 0.0, 0.0, 0.0)
_DYNAMIC: Final = Qos("transforms", reliable=True, latched=False, depth=100)


def body_in_map(message: Any, view: VehicleView) -> Values:
    """Return tf2_msgs/TFMessage: the pose of the body in the map."""
    seconds, nanoseconds = divmod(view.stamp(message), 1_000_000_000)
    frames = view.frames
    position = ned_enu(message.x, message.y, message.z)
    return (((seconds, nanoseconds, frames.map, frames.base_link, *position, *view.attitude()),),)


def fixed_axes(_message: Any, view: VehicleView) -> Values:
    """Return tf2_msgs/TFMessage: the MAVLink axes in the ROS axes."""
    seconds, nanoseconds = divmod(view.arrival, 1_000_000_000)
    frames = view.frames
    pairs = (
        (frames.map, "_ned", _NED_IN_ENU),
        (frames.odom, "_ned", _NED_IN_ENU),
        (frames.base_link, "_frd", _FRD_IN_FLU),
    )
    return (
        tuple(
            (seconds, nanoseconds, name, name + suffix, 0.0, 0.0, 0.0, *rotation)
            for name, suffix, rotation in pairs
        ),
    )


TF: Final = Publication(
    "/tf",
    "tf2_msgs/msg/TFMessage",
    (common.LocalPositionNed,),
    body_in_map,
    _DYNAMIC,
    meaning="map to base_link",
    difference="sent if somebody subscribes; MAVROS needs a parameter",
)
STATIC_TF: Final = Publication(
    "/tf_static",
    "tf2_msgs/msg/TFMessage",
    (common.Heartbeat,),
    fixed_axes,
    LATCHED,
    meaning="map_ned, odom_ned, base_link_frd",
)
