"""Channels with the schemas of Foxglove beside those of ROS, made of topics: map, 3D view and log.

Foxglove's map shows NavSatFix and its 3D view TFMessage and PoseStamped; these channels are for the panels
that know the schemas of Foxglove alone, and for programs without ROS.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

from foxglove import messages

from mavstack.bridges.core.types import codec_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.bridges.core.topic import Topic

Fields = dict[str, Any]
_NANOSECONDS: Final = 1_000_000_000
#: Foxglove log levels by MAV_SEVERITY.
_LEVELS: Final = (
    *(messages.LogLevel.Fatal,) * 3,
    messages.LogLevel.Error,
    messages.LogLevel.Warning,
    *(messages.LogLevel.Info,) * 2,
    messages.LogLevel.Debug,
)
#: Mission items with this MAV_CMD or a larger one have no position.
_FIRST_WITHOUT_PLACE: Final = 95


@dataclass(frozen=True, slots=True)
class Panel:
    """A channel for a panel.

    Attributes:
        name: The name of its topic, below the namespace of the vehicle.
        message: The class of its messages.
        make: Makes a message of the fields of a sample and its time.
    """

    name: str
    message: Any
    make: Callable[[Fields, Any], Any]

    def encode(self, topic: Topic, payload: bytes, stamp: int) -> bytes:
        """Return the message of a sample, as protobuf."""
        seconds, nanoseconds = divmod(stamp, _NANOSECONDS)
        fields = codec_of(topic.type).decode_fields(payload)
        encoded: bytes = self.make(fields, messages.Timestamp(seconds, nanoseconds)).encode()
        return encoded


def location(fields: Fields, time: Any) -> Any:
    """Return foxglove.LocationFix for sensor_msgs/NavSatFix."""
    return messages.LocationFix(
        timestamp=time,
        frame_id=fields["header"]["frame_id"],
        latitude=fields["latitude"],
        longitude=fields["longitude"],
        altitude=fields["altitude"],
        position_covariance=list(fields["position_covariance"]),
        position_covariance_type=messages.LocationFixPositionCovarianceType.DiagonalKnown
        if fields["position_covariance_type"]
        else messages.LocationFixPositionCovarianceType.Unknown,
    )


def pose(fields: Fields, time: Any) -> Any:
    """Return foxglove.PoseInFrame for geometry_msgs/PoseStamped."""
    return messages.PoseInFrame(
        timestamp=time,
        frame_id=fields["header"]["frame_id"],
        pose=messages.Pose(
            position=messages.Vector3(**fields["pose"]["position"]),
            orientation=messages.Quaternion(**fields["pose"]["orientation"]),
        ),
    )


def transforms(fields: Fields, time: Any) -> Any:
    """Return foxglove.FrameTransforms for tf2_msgs/TFMessage."""
    return messages.FrameTransforms(
        transforms=[
            messages.FrameTransform(
                timestamp=time,
                parent_frame_id=each["header"]["frame_id"],
                child_frame_id=each["child_frame_id"],
                translation=messages.Vector3(**each["transform"]["translation"]),
                rotation=messages.Quaternion(**each["transform"]["rotation"]),
            )
            for each in fields["transforms"]
        ]
    )


def log(fields: Fields, time: Any) -> Any:
    """Return foxglove.Log for mavros_msgs/StatusText."""
    level = _LEVELS[min(fields["severity"], len(_LEVELS) - 1)]
    return messages.Log(timestamp=time, level=level, message=fields["text"], name="vehicle")


def plan(fields: Fields, _time: Any) -> Any:
    """Return foxglove.GeoJSON for mavros_msgs/WaypointList: its way as a line, and its items as points."""
    places = [
        (number, item["y_long"], item["x_lat"])
        for number, item in enumerate(fields["waypoints"])
        if item["command"] < _FIRST_WITHOUT_PLACE and _is_place(item["x_lat"], item["y_long"])
    ]
    line = {"type": "LineString", "coordinates": [place[1:] for place in places]}
    found: list[Fields] = [{"type": "Feature", "properties": {"name": "mission"}, "geometry": line}]
    found += [
        {
            "type": "Feature",
            "properties": {"name": str(number)},
            "geometry": {"type": "Point", "coordinates": [longitude, latitude]},
        }
        for number, longitude, latitude in places
    ]
    return messages.GeoJson(geojson=json.dumps({"type": "FeatureCollection", "features": found}))


def _is_place(latitude: float, longitude: float) -> bool:
    return isfinite(latitude) and isfinite(longitude) and bool(latitude or longitude)


#: The Foxglove channels, by the name of the row whose samples they convert.
PANELS: Final = {
    "global_position/global": Panel("foxglove/location", messages.LocationFix, location),
    "local_position/pose": Panel("foxglove/pose", messages.PoseInFrame, pose),
    "/tf": Panel("foxglove/transforms", messages.FrameTransforms, transforms),
    "statustext/recv": Panel("foxglove/log", messages.Log, log),
    "mission/waypoints": Panel("foxglove/mission", messages.GeoJson, plan),
}
