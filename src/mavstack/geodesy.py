"""The Earth: its size, distances and offsets on it, and metres around an origin. Everything is WGS 84.

- `LocalFrame` is the ellipsoid, for motion. A small step north is M(latitude) metres per radian, and a small
  step east N(latitude) cos(latitude). Over a distance both are taken at the mean latitude, which leaves
  errors of about 1e-5 of the distance at 50 km: the local plane is rolled onto the Earth, so that `down`
  stays the height above the surface at any distance. The way back finds the mean latitude by iteration.
- `distance`, `offset`, `offset_location` and `METRES_PER_DEGREE` are the sphere with the mean radius, for
  decisions and displays: they are cheap, and wrong by up to 0.6 % of a distance.

A firmware that counts with another radius has it here under its name, where results must equal those of the
firmware.
"""

from __future__ import annotations

import math
from typing import Final

#: Semi-major axis of the ellipsoid in metres, and square of its eccentricity.
SEMI_MAJOR_AXIS: Final = 6378137.0
ECCENTRICITY_SQUARED: Final = 6.69437999014e-3
#: Mean radius of the ellipsoid in metres: (2 a + b) / 3.
MEAN_RADIUS: Final = 6_371_008.8
#: Metres per degree on the sphere with the mean radius.
METRES_PER_DEGREE: Final = math.radians(MEAN_RADIUS)
#: The radius of the earth in metres that ArduPilot's terrain grid uses.
ARDUPILOT_RADIUS: Final = 6_378_100.0
#: The radius in metres of the sphere of the World Magnetic Model.
MAGNETIC_RADIUS: Final = 6_371_200.0
#: Lower bound of the cosine of the latitude, which is 0 at a pole, where east is undefined.
MIN_COSINE = 1e-6
#: The iteration ends when the latitude changes by less than this, in degrees (a tenth of a millimetre).
LATITUDE_TOLERANCE = 1e-9


def offset(latitude: float, longitude: float, to_latitude: float, to_longitude: float) -> tuple[float, float]:
    """Return the metres north and east from one location to another on the sphere, the shorter way round.

    Args:
        latitude: Degrees, of the first location.
        longitude: Degrees, of the first location.
        to_latitude: Degrees, of the second location.
        to_longitude: Degrees, of the second location.
    """
    middle = math.radians((latitude + to_latitude) / 2)
    east = math.remainder(to_longitude - longitude, 360.0) * math.cos(middle)
    return (to_latitude - latitude) * METRES_PER_DEGREE, east * METRES_PER_DEGREE


def distance(latitude: float, longitude: float, to_latitude: float, to_longitude: float) -> float:
    """Return the ground distance between two locations in metres, the shorter way round."""
    return math.hypot(*offset(latitude, longitude, to_latitude, to_longitude))


def offset_location(latitude: float, longitude: float, north: float, east: float) -> tuple[float, float]:
    """Return the latitude and longitude `north` and `east` metres from a location."""
    to_latitude = min(max(latitude + north / METRES_PER_DEGREE, -90.0), 90.0)
    parallel = max(math.cos(math.radians((latitude + to_latitude) / 2)), 1e-9)  # east is undefined at a pole
    to_longitude = longitude + east / (METRES_PER_DEGREE * parallel)
    return to_latitude, (to_longitude + 180.0) % 360.0 - 180.0


def radii_of_curvature(latitude: float) -> tuple[float, float]:
    """Return metres per radian northwards and eastwards at a latitude in radians."""
    sine = math.sin(latitude)
    shrink = 1.0 - ECCENTRICITY_SQUARED * sine * sine
    across = SEMI_MAJOR_AXIS / math.sqrt(shrink)
    return across * (1.0 - ECCENTRICITY_SQUARED) / shrink, across * max(math.cos(latitude), MIN_COSINE)


class LocalFrame:
    """North, east, down in metres around an origin.

    Args:
        latitude: Origin in degrees.
        longitude: Origin in degrees.
        altitude: Origin in metres above mean sea level.
    """

    __slots__ = ("_along", "altitude", "latitude", "longitude")

    def __init__(self, latitude: float, longitude: float, altitude: float) -> None:
        self.latitude = latitude
        self.longitude = longitude
        self.altitude = altitude
        self._along, _ = radii_of_curvature(math.radians(latitude))

    def to_local(self, latitude: float, longitude: float, altitude: float) -> tuple[float, float, float]:
        """Return (north, east, down) in metres of a position in degrees and metres of altitude."""
        along, across = radii_of_curvature(math.radians(0.5 * (latitude + self.latitude)))
        east = math.remainder(longitude - self.longitude, 360.0)
        return (
            math.radians(latitude - self.latitude) * along,
            math.radians(east) * across,
            self.altitude - altitude,
        )

    def to_global(self, north: float, east: float, down: float) -> tuple[float, float, float]:
        """Return (latitude, longitude, altitude) of a local position in degrees and metres."""
        latitude, across = self.latitude + math.degrees(north / self._along), 1.0
        for _ in range(3):
            before = latitude
            along, across = radii_of_curvature(math.radians(0.5 * (latitude + self.latitude)))
            latitude = min(max(self.latitude + math.degrees(north / along), -90.0), 90.0)
            if abs(latitude - before) < LATITUDE_TOLERANCE:
                break
        longitude = math.remainder(self.longitude + math.degrees(east / across), 360.0)
        return latitude, longitude, self.altitude - down

    def __repr__(self) -> str:
        return f"LocalFrame({self.latitude}, {self.longitude}, {self.altitude})"
