"""The fixes of satellite navigation in a log, as fingerprints by which logs of one flight are recognised.

The radio link and the vehicle's own log hold the same fixes with the same digits, at their own times. A
position that occurs only within a short time is a fingerprint of that time; a parked vehicle repeats
positions, which are left out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.time_base import ClockChoice

#: Tables with fixes: name, column of latitude, column of longitude, degrees per unit of these columns.
_SOURCES: Final = (
    ("GPS_RAW_INT", "lat", "lon", 1e-7),
    ("GPS2_RAW", "lat", "lon", 1e-7),
    ("GPS", "Lat", "Lng", 1.0),
    ("GPS2", "Lat", "Lng", 1.0),
    ("vehicle_gps_position", "latitude_deg", "longitude_deg", 1.0),
    ("vehicle_gps_position", "lat", "lon", 1e-7),
    ("sensor_gps", "latitude_deg", "longitude_deg", 1.0),
    ("sensor_gps", "lat", "lon", 1e-7),
)
#: Maximum seconds between occurrences of the same fix, which may be sent or logged several times.
_MAX_REPETITION: Final = 2.0
#: Positions are compared in units of 1e-7 degrees, as in GPS_RAW_INT.
_UNITS_PER_DEGREE: Final = 1e7


def gps_fixes(log: Log, clock: ClockChoice) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the fingerprints of the fixes in a log, and the first time of each.

    Args:
        log: The log.
        clock: The clock of the times, as in `Log.times`.

    Returns:
        Distinct numbers, each of one position, in ascending order; and their times in seconds.
    """
    found = [
        (_fingerprints(log[name], latitude, longitude, unit), log.times(name, clock))
        for name, latitude, longitude, unit in _SOURCES
        if name in log and log.schema(name).has_numbers(latitude, longitude)
    ]
    if not found:
        return np.empty(0, np.int64), np.empty(0)
    keys, times = (np.concatenate(parts) for parts in zip(*found, strict=True))
    known = (keys != 0) & ~np.isnan(times)
    keys, times = keys[known], times[known]
    order = np.lexsort((times, keys))
    keys, times = keys[order], times[order]
    distinct, first, counts = np.unique(keys, return_index=True, return_counts=True)
    short = times[first + counts - 1] - times[first] <= _MAX_REPETITION
    return distinct[short], times[first][short]


def _fingerprints(table: MessageTable, latitude: str, longitude: str, unit: float) -> NDArray[np.int64]:
    """Return one number for each position: 0 for the position 0, 0, which means "no fix"."""
    factor = unit * _UNITS_PER_DEGREE
    columns = [np.asarray(table[name]).astype(np.float64) * factor for name in (latitude, longitude)]
    limits = 90 * _UNITS_PER_DEGREE, 180 * _UNITS_PER_DEGREE
    on_earth = (np.abs(columns[0]) <= limits[0]) & (np.abs(columns[1]) <= limits[1])
    north, east = (np.rint(np.where(on_earth, column, 0.0)).astype(np.int64) for column in columns)
    keys: NDArray[np.int64] = (north << 32) ^ (east & 0xFFFFFFFF)
    return keys
