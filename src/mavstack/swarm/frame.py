"""Positions of all vehicles at once between degrees and metres around an origin: `LocalFrame` for arrays.

A controller converts the positions and the setpoints of hundreds of vehicles in each step, so both ways work
on arrays. Results equal those of `LocalFrame`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.geodesy import ECCENTRICITY_SQUARED, MIN_COSINE, SEMI_MAJOR_AXIS

if TYPE_CHECKING:
    from mavstack.geodesy import LocalFrame
    from mavstack.swarm.arrays import Points

#: Steps of the iteration for the mean latitude; each makes the error a thousand times smaller or more.
_ITERATIONS: Final = 3


def to_local(frame: LocalFrame, places: Points) -> Points:
    """Return metres north, east, up of a frame's origin.

    Args:
        frame: The frame.
        places: Degrees of latitude and longitude, and metres of altitude; an array of shape (n, 3).
    """
    latitude, longitude, altitude = places.T
    along, across = _radii(0.5 * (latitude + frame.latitude))
    east = (longitude - frame.longitude + 180.0) % 360.0 - 180.0
    return np.column_stack(
        (
            np.radians(latitude - frame.latitude) * along,
            np.radians(east) * across,
            altitude - frame.altitude,
        )
    )


def to_global(frame: LocalFrame, points: Points) -> Points:
    """Return degrees of latitude and longitude, and metres of altitude.

    Args:
        frame: The frame.
        points: Metres north, east, up; an array of shape (n, 3).
    """
    north, east, up = points.T
    latitude: Points = np.full(len(points), frame.latitude)
    along, across = _radii(latitude)
    for _ in range(_ITERATIONS):
        latitude = np.clip(frame.latitude + np.degrees(north / along), -90.0, 90.0)
        along, across = _radii(0.5 * (latitude + frame.latitude))
    longitude = (frame.longitude + np.degrees(east / across) + 180.0) % 360.0 - 180.0
    return np.column_stack((latitude, longitude, frame.altitude + up))


def _radii(latitude: Points) -> tuple[Points, Points]:
    """Return metres per radian northwards and eastwards at latitudes in degrees."""
    angle = np.radians(latitude)
    sine = np.sin(angle)
    shrink = 1.0 - ECCENTRICITY_SQUARED * sine * sine
    across = SEMI_MAJOR_AXIS / np.sqrt(shrink)
    along: Points = across * (1.0 - ECCENTRICITY_SQUARED) / shrink
    return along, across * np.maximum(np.cos(angle), MIN_COSINE)
