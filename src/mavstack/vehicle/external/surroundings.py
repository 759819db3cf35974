"""The surroundings of a vehicle as a companion computer sees them: methods of `External`."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.rotation import from_euler, rotate
from mavstack.services.arguments import check_numbers
from mavstack.services.external import (
    distance_message,
    follow_message,
    landing_angles,
    landing_message,
    obstacle_message,
)
from mavstack.vehicle.external.times import microseconds

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.rotation import Quaternion, Vector
    from mavstack.vehicle.external.external import External
    from mavstack.vehicle.vehicle import Vehicle

_DOWN: Final = common.MavSensorOrientation.PITCH_270
_LASER: Final = common.MavDistanceSensor.LASER
#: Seconds after which a pose of the vehicle is too old to convert a target.
_MAX_POSE_AGE: Final = 1.0


def obstacles(
    external: External,
    distances: Sequence[float],
    *,
    min_distance: float = 0.2,
    max_distance: float = 40.0,
    increment: float | None = None,
    angle_offset: float = 0.0,
    kind: int = _LASER,
    time: float | None = None,
) -> None:
    """Send the distances of obstacles around the vehicle (OBSTACLE_DISTANCE), at 10 Hz or more.

    Args:
        distances: Metres in up to 72 sectors, clockwise; infinity: free, NaN: not known. For a laser scan
            of ROS `mavstack.services.external.scan_sectors` makes them.
        min_distance: The smallest distance that the sensor measures, metres.
        max_distance: The largest distance that the sensor measures, metres.
        increment: The width of a sector, degrees; None: the sectors go around.
        angle_offset: The direction of the first sector, degrees from forward, clockwise.
        kind: The MAV_DISTANCE_SENSOR.
        time: The time of the measurement, Unix seconds; None: now.

    Raises:
        InvalidArgumentError: A number is not possible.
        InvalidStateError: The connection is closed.
    """
    external.vehicle.component.send(
        obstacle_message(
            distances,
            microseconds(external.vehicle, time),
            min_distance=min_distance,
            max_distance=max_distance,
            increment=increment,
            angle_offset=angle_offset,
            kind=kind,
        )
    )


def distance(
    external: External,
    distance: float,
    *,
    orientation: int = _DOWN,
    min_distance: float = 0.2,
    max_distance: float = 40.0,
    kind: int = _LASER,
    number: int = 0,
    time: float | None = None,
) -> None:
    """Send the distance that a rangefinder measures (DISTANCE_SENSOR).

    Args:
        distance: Metres; infinity: nothing in range.
        orientation: The MAV_SENSOR_ORIENTATION; 25 (PITCH_270) looks down, 0 forward.
        min_distance: The smallest distance that the sensor measures, metres.
        max_distance: The largest distance that the sensor measures, metres.
        kind: The MAV_DISTANCE_SENSOR.
        number: The id of the sensor.
        time: The time of the measurement, Unix seconds; None: now.

    Raises:
        InvalidArgumentError: A number is not possible.
        InvalidStateError: The connection is closed.
    """
    external.vehicle.component.send(
        distance_message(
            distance,
            microseconds(external.vehicle, time) // 1000,
            orientation=orientation,
            min_distance=min_distance,
            max_distance=max_distance,
            kind=kind,
            number=number,
        )
    )


def landing_target(
    external: External,
    forward: float,
    right: float,
    down: float,
    *,
    number: int = 0,
    time: float | None = None,
) -> None:
    """Send the place to land on as the vehicle sees it (LANDING_TARGET), at 10 Hz or more.

    ArduPilot gets it in the axes of the body; PX4 gets it in the local frame while the pose of the vehicle
    is known, otherwise as angles.

    Args:
        forward: Metres from the vehicle along its nose.
        right: Metres to the right of it.
        down: Metres below it.
        number: The number of the target.
        time: The time of the measurement, Unix seconds; None: now.

    Raises:
        InvalidArgumentError: A number is not possible.
        InvalidStateError: The connection is closed.
    """
    check_numbers(forward=forward, right=right, down=down)
    seen, angles = (forward, right, down), landing_angles(forward, right, down)
    moment = microseconds(external.vehicle, time)
    message = landing_message(seen, moment, angles=angles, number=number)
    if external.vehicle.autopilot == common.MavAutopilot.PX4:
        place = _in_local_frame(external.vehicle, seen)
        if place is None:
            message = message.replace(position_valid=0)
        else:
            frame = common.MavFrame.LOCAL_NED
            message = landing_message(place, moment, frame=frame, angles=angles, number=number)
    external.vehicle.component.send(message)


def follow_target(
    external: External,
    latitude: float,
    longitude: float,
    altitude: float,
    *,
    velocity: Vector | None = None,
    acceleration: Vector | None = None,
    orientation: Quaternion | None = None,
    time: float | None = None,
) -> None:
    """Send the position of a target to follow (FOLLOW_TARGET); the mode of the vehicle is not changed.

    Args:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above mean sea level.
        velocity: Metres per second north, east, down; None: not known.
        acceleration: Metres per second squared north, east, down; None: not known.
        orientation: The quaternion of the target w, x, y, z, FRD in NED; None: not known.
        time: The time of the measurement, Unix seconds; None: now.

    Raises:
        InvalidArgumentError: The place is not on Earth.
        InvalidStateError: The connection is closed.
    """
    timestamp = microseconds(external.vehicle, time) // 1000
    message = follow_message(
        latitude,
        longitude,
        altitude,
        timestamp,
        velocity=velocity,
        acceleration=acceleration,
        attitude=orientation,
    )
    external.vehicle.component.send(message)


def _in_local_frame(vehicle: Vehicle, seen: Vector) -> Vector | None:
    """Return a point in the axes of the body in the local frame; None if the pose is not known."""
    place, attitude = vehicle.local_position, vehicle.attitude
    age = vehicle.age(common.LocalPositionNed)
    if place is None or attitude is None or age is None or age > _MAX_POSE_AGE:
        return None
    turned = rotate(
        from_euler(*(radians(each) for each in (attitude.roll, attitude.pitch, attitude.yaw))), seen
    )
    return place.north + turned[0], place.east + turned[1], place.down + turned[2]
