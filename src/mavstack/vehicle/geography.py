"""Distances on the Earth, good to a part in a thousand over what a vehicle flies."""

from __future__ import annotations

from math import cos, degrees, hypot, radians

#: Mean radius, in metres.
EARTH = 6_371_000.0


def distance(latitude: float, longitude: float, to_latitude: float, to_longitude: float) -> float:
    """Metres between two places, the shorter way round."""
    east = (to_longitude - longitude + 180.0) % 360.0 - 180.0
    middle = radians((latitude + to_latitude) / 2)
    return EARTH * hypot(radians(to_latitude - latitude), radians(east) * cos(middle))


def moved(latitude: float, longitude: float, north: float, east: float) -> tuple[float, float]:
    """The place so many metres north and east of another; at a pole there is no east."""
    to_latitude = min(max(latitude + degrees(north / EARTH), -90.0), 90.0)
    narrowed = max(cos(radians((latitude + to_latitude) / 2)), 1e-9)
    to_longitude = longitude + degrees(east / (EARTH * narrowed))
    return to_latitude, (to_longitude + 180.0) % 360.0 - 180.0
