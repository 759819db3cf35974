"""Conversion from latitude and longitude to metres around an origin, and back.

On the WGS 84 ellipsoid a small step north is M(latitude) metres per radian, and a small step east N(latitude)
cos(latitude). Over a distance both are taken at the mean latitude, which leaves errors of about 1e-5 of the
distance at 50 km: the local plane is rolled onto the Earth, so that `down` stays the height above the surface
at any distance. The way back finds the mean latitude by iteration.
"""

from __future__ import annotations

import math

#: WGS 84: semi-major axis in metres, and square of the eccentricity.
SEMI_MAJOR_AXIS = 6378137.0
ECCENTRICITY_SQUARED = 6.69437999014e-3
#: Lower bound of the cosine of the latitude: at a pole, east is undefined.
MIN_COSINE = 1e-6
#: The iteration ends when the latitude changes by less than this, in degrees (a tenth of a millimetre).
LATITUDE_TOLERANCE = 1e-9


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
