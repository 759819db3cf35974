"""Aircraft out of partial reports, and how near two of them come.

Receivers report a position, a velocity and a callsign one at a time, each of them about once a second. The
table joins them by the 24-bit address and forgets an aircraft after a minute without a report.
"""

from __future__ import annotations

from math import cos, hypot, isfinite, radians, sin
from typing import Final, NamedTuple

from mavstack.geodesy import distance, offset

#: In seconds: the age of the last report after which an aircraft is discarded, and the age after which a
#: position is no longer used.
MAX_AGE: Final = 60.0
MAX_POSITION_AGE: Final = 30.0
#: Maximum number of aircraft; a new aircraft then replaces the aircraft with the oldest report.
MAX_AIRCRAFT: Final = 20_000


class Report(NamedTuple):
    """A part of the state of an aircraft; None: not reported.

    Attributes:
        address: The address of its transponder, 24 bits.
        callsign: The callsign.
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres.
        is_geometric: True if the altitude is from satellite navigation, False: from the pressure.
        course: Degrees over ground.
        speed: Metres per second over ground.
        climb: Metres per second, positive up.
        squawk: The code of the transponder, as four octal digits read as a decimal number.
    """

    address: int
    callsign: str | None = None
    latitude: float | None = None
    longitude: float | None = None
    altitude: float | None = None
    is_geometric: bool | None = None
    course: float | None = None
    speed: float | None = None
    climb: float | None = None
    squawk: int | None = None


class Aircraft(NamedTuple):
    """An aircraft as it was reported last; the units are those of `Report`, times are Unix seconds."""

    address: int
    seen: float
    positioned: float | None = None
    callsign: str | None = None
    latitude: float | None = None
    longitude: float | None = None
    altitude: float | None = None
    is_geometric: bool = False
    course: float | None = None
    speed: float | None = None
    climb: float | None = None
    squawk: int | None = None


class AircraftTable:
    """The aircraft that were reported, by address."""

    def __init__(self) -> None:
        self._aircraft: dict[int, Aircraft] = {}

    def __len__(self) -> int:
        return len(self._aircraft)

    def update(self, report: Report, now: float) -> Aircraft:
        """Add a report to its aircraft; returns the aircraft."""
        # One call with all fields: a receiver sends thousands of reports a second.
        known = self._aircraft.pop(report.address, None) or Aircraft(report.address, now)
        latitude, longitude = report.latitude, report.longitude
        positioned: float | None = now
        if latitude is None or longitude is None or not (abs(latitude) <= 90 and abs(longitude) <= 180):
            latitude, longitude, positioned = known.latitude, known.longitude, known.positioned
        self._aircraft[report.address] = changed = Aircraft(
            report.address,
            now,
            positioned,
            report.callsign or known.callsign,
            latitude,
            longitude,
            _newer(report.altitude, known.altitude),
            known.is_geometric if report.is_geometric is None else report.is_geometric,
            _newer(report.course, known.course),
            _newer(report.speed, known.speed),
            _newer(report.climb, known.climb),
            known.squawk if report.squawk is None else report.squawk,
        )
        if len(self._aircraft) > MAX_AIRCRAFT:
            del self._aircraft[next(iter(self._aircraft))]
        return changed

    def forget_old(self, now: float) -> None:
        """Forget the aircraft that were not reported for `MAX_AGE` seconds."""
        for address, aircraft in list(self._aircraft.items()):
            if now - aircraft.seen <= MAX_AGE:
                break  # the aircraft are in the order of their last reports
            del self._aircraft[address]

    def all(self) -> list[Aircraft]:
        """Return all aircraft, the one that was reported last behind the others."""
        return list(self._aircraft.values())

    def nearest(
        self, latitude: float, longitude: float, now: float, *, count: int, reach: float
    ) -> list[tuple[float, Aircraft]]:
        """Return the aircraft around a location with their distances in metres, the nearest first.

        Args:
            latitude: Degrees.
            longitude: Degrees.
            now: Unix seconds; older positions than `MAX_POSITION_AGE` do not count.
            count: The largest number of aircraft.
            reach: The largest distance in metres.
        """
        found = []
        for aircraft in self._aircraft.values():
            if aircraft.latitude is None or aircraft.longitude is None:
                continue
            if aircraft.positioned is None or now - aircraft.positioned > MAX_POSITION_AGE:
                continue
            metres = distance(latitude, longitude, aircraft.latitude, aircraft.longitude)
            if metres <= reach:
                found.append((metres, aircraft))
        found.sort(key=lambda item: item[0])
        return found[:count]


class Approach(NamedTuple):
    """The closest approach of two aircraft that keep their velocities: seconds until then, and metres."""

    time: float
    horizontal: float
    vertical: float


def closest_approach(one: Aircraft, other: Aircraft) -> Approach | None:
    """Return the closest approach of two aircraft; None if a position is not known.

    A velocity that is not known counts as 0, as does the vertical distance without both altitudes.
    """
    if one.latitude is None or one.longitude is None or other.latitude is None or other.longitude is None:
        return None
    north, east = offset(one.latitude, one.longitude, other.latitude, other.longitude)
    (vn, ve, vu), (wn, we, wu) = _velocity(one), _velocity(other)
    known = one.altitude is not None and other.altitude is not None
    up = (other.altitude or 0.0) - (one.altitude or 0.0) if known else 0.0
    dn, de, du = wn - vn, we - ve, wu - vu
    squared = dn * dn + de * de
    time = max(-(north * dn + east * de) / squared, 0.0) if squared > 1e-6 else 0.0
    return Approach(time, hypot(north + dn * time, east + de * time), abs(up + du * time))


def _velocity(aircraft: Aircraft) -> tuple[float, float, float]:
    speed, angle = aircraft.speed or 0.0, radians(aircraft.course or 0.0)
    return speed * cos(angle), speed * sin(angle), aircraft.climb or 0.0


def _newer(value: float | None, known: float | None) -> float | None:
    """Return a reported value, or the known one if none, or none that is a number, was reported."""
    return value if value is not None and isfinite(value) else known
