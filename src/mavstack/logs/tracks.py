"""The tracks of the vehicles in a log: where they were, and when.

A log holds the position several times: as the estimator computed it, and as each receiver of satellite
navigation measured it. The first source in `_SOURCES` that the log has is taken, the estimate first. Rows
without a position (no fix, 0/0, out of range, no altitude) are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from mavstack.errors import LogError
from mavstack.geodesy import MEAN_RADIUS
from mavstack.logs.own_system import own_system

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable


class _Source(NamedTuple):
    """A table with positions; factors convert to degrees and metres, `fix` must be at least `min_fix`.

    A factor of 0 stands for the multiplier of the table's schema.
    """

    table: str
    latitude: str
    longitude: str
    altitude: str
    degrees: float = 1.0
    metres: float = 1.0
    fix: str = ""
    min_fix: int = 3

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns that are read."""
        names = (self.latitude, self.longitude, self.altitude)
        return (*names, self.fix) if self.fix else names


_SOURCES: Final = (
    _Source("GLOBAL_POSITION_INT", "lat", "lon", "alt", 1e-7, 1e-3),
    _Source("POS", "Lat", "Lng", "Alt"),
    _Source("vehicle_global_position", "lat", "lon", "alt"),
    _Source("GPS_RAW_INT", "lat", "lon", "alt", 1e-7, 1e-3, "fix_type"),
    _Source("GPS2_RAW", "lat", "lon", "alt", 1e-7, 1e-3, "fix_type"),
    _Source("GPS", "Lat", "Lng", "Alt", fix="Status"),
    _Source("vehicle_gps_position", "latitude_deg", "longitude_deg", "altitude_msl_m", fix="fix_type"),
    _Source("vehicle_gps_position", "lat", "lon", "alt", 1e-7, 1e-3, "fix_type"),
    _Source("sensor_gps", "latitude_deg", "longitude_deg", "altitude_msl_m", fix="fix_type"),
    _Source("sensor_gps", "lat", "lon", "alt", 1e-7, 1e-3, "fix_type"),
    _Source("AHR2", "Lat", "Lng", "Alt"),
    _Source("GPS", "GPS_coord[0]", "GPS_coord[1]", "GPS_altitude", 1e-7, 0.0),
)


@dataclass(frozen=True, eq=False)
class Track:
    """The track of a vehicle.

    Attributes:
        system: System id; 0 in logs that do not name it.
        source: Name of the table that the positions come from.
        times: Seconds on the time base of the log: since 1970, or since boot.
        latitudes: Degrees north.
        longitudes: Degrees east.
        altitudes: Metres above mean sea level.
    """

    system: int
    source: str
    times: NDArray[np.float64]
    latitudes: NDArray[np.float64]
    longitudes: NDArray[np.float64]
    altitudes: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.times)

    @property
    def distance(self) -> float:
        """Length of the track over ground in metres."""
        steps = distances(self.latitudes[:-1], self.longitudes[:-1], self.latitudes[1:], self.longitudes[1:])
        return float(steps.sum())

    def thinned(self, max_points: int) -> Track:
        """Return the track with at most so many points, evenly chosen; the first and the last stay.

        Args:
            max_points: Maximum number of points, at least 2.
        """
        if len(self) <= max_points:
            return self
        kept = np.unique(np.linspace(0, len(self) - 1, max_points).round().astype(np.intp))
        columns = (self.times, self.latitudes, self.longitudes, self.altitudes)
        return Track(self.system, self.source, *(column[kept] for column in columns))


def tracks(log: Log) -> list[Track]:
    """Return the track of each vehicle in a log.

    Args:
        log: The log, or a view of it.

    Returns:
        The tracks by ascending system id; vehicles without positions are left out.

    Raises:
        LogError: The log cannot be read.
    """
    found: dict[int, Track] = {}
    for source in _SOURCES:
        if source.table in log and log.schema(source.table).has_numbers(*source.columns):
            for track in _tracks_of(log, source):
                found.setdefault(track.system, track)
    return [track for _, track in sorted(found.items())]


def distances(
    from_latitude: NDArray[np.float64],
    from_longitude: NDArray[np.float64],
    to_latitude: NDArray[np.float64],
    to_longitude: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return great-circle distances in metres between positions in degrees."""
    first, second = np.radians(from_latitude), np.radians(to_latitude)
    half_longitude = np.radians(to_longitude - from_longitude) / 2
    chord = np.sin((second - first) / 2) ** 2 + np.cos(first) * np.cos(second) * np.sin(half_longitude) ** 2
    angles: NDArray[np.float64] = 2 * MEAN_RADIUS * np.arcsin(np.sqrt(np.clip(chord, 0, 1)))
    return angles


def _tracks_of(log: Log, source: _Source) -> Iterator[Track]:
    table = log[source.table]
    # A log of one vehicle may hold several receivers; use the first one.
    if "_instance" in (table.dtype.names or ()) and len(table):
        table = table.where(table["_instance"] == table["_instance"].min())
    try:
        times = log.times_of(source.table, table)
    except LogError:
        return
    systems = _systems(log, table)
    for system in np.unique(systems).tolist():
        track = _track(source, table, times, systems == system, system)
        if len(track):
            yield track


def _systems(log: Log, table: MessageTable) -> NDArray[np.int64]:
    if "_system" in (table.dtype.names or ()):
        return np.asarray(table["_system"]).astype(np.int64)
    return np.full(len(table), own_system(log))


def _track(
    source: _Source, table: MessageTable, times: NDArray[np.float64], rows: NDArray[np.bool_], system: int
) -> Track:
    latitudes = np.asarray(table[source.latitude]).astype(np.float64) * source.degrees
    longitudes = np.asarray(table[source.longitude]).astype(np.float64) * source.degrees
    metres = source.metres or table.schema[source.altitude].multiplier
    altitudes = np.asarray(table[source.altitude]).astype(np.float64) * metres
    valid = rows & ((latitudes != 0) | (longitudes != 0)) & np.isfinite(times)
    valid &= (np.abs(latitudes) <= 90) & (np.abs(longitudes) <= 180) & np.isfinite(altitudes)
    if source.fix:
        valid &= np.asarray(table[source.fix]) >= source.min_fix
    return Track(system, source.table, times[valid], latitudes[valid], longitudes[valid], altitudes[valid])
