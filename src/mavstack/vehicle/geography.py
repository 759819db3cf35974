"""Locations and distances on the Earth, accurate to a part in a thousand over the range of a vehicle."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, degrees, hypot, radians

#: Mean radius of the Earth, in metres.
EARTH_RADIUS = 6_371_000.0


@dataclass(frozen=True, slots=True)
class Location:
    """A target location: degrees, and metres above home (None: the present altitude)."""

    latitude: float
    longitude: float
    altitude: float | None = None


def distance(latitude: float, longitude: float, to_latitude: float, to_longitude: float) -> float:
    """Return the ground distance between two locations in metres, the shorter way round."""
    east = (to_longitude - longitude + 180.0) % 360.0 - 180.0
    middle = radians((latitude + to_latitude) / 2)
    return EARTH_RADIUS * hypot(radians(to_latitude - latitude), radians(east) * cos(middle))


def offset_location(latitude: float, longitude: float, north: float, east: float) -> tuple[float, float]:
    """Return the latitude and longitude `north` and `east` metres from a location."""
    to_latitude = min(max(latitude + degrees(north / EARTH_RADIUS), -90.0), 90.0)
    parallel = max(cos(radians((latitude + to_latitude) / 2)), 1e-9)  # there is no east at a pole
    to_longitude = longitude + degrees(east / (EARTH_RADIUS * parallel))
    return to_latitude, (to_longitude + 180.0) % 360.0 - 180.0
