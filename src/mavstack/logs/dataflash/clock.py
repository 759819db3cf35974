"""Time since boot and UTC in a DataFlash log.

Records hold the time since boot (TimeUS, in old logs TimeMS). GPS records hold the week and the milliseconds
of GPS time as well, which gives the offset to UTC. GPS time does not count leap seconds; it is 18 s ahead of
UTC since 2017 (15 s in 2009, one more in July 2012, in July 2015 and in January 2017).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.logs.dataflash.record_type import NEIGHBOUR_TIME
from mavstack.logs.time_base import TimeBase, median_offset

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from mavstack.logs.dataflash.record_type import RecordType

#: Marks a time that is not known.
NO_TIME: Final = np.iinfo(np.int64).min
GPS_TABLES: Final = ("GPS", "GPS2")
_GPS_EPOCH_US: Final = 315_964_800_000_000
_WEEK_US: Final = 604_800_000_000
#: Maximum GPS week, in the year 2172: a larger number is damaged.
_MAX_WEEK: Final = 9999
#: Leap seconds before July 2012, and the GPS times in microseconds of later leap seconds.
_FIRST_LEAP_SECONDS: Final = 15
_LEAP_STEPS_US: Final = np.array([1_025_136_015, 1_119_744_016, 1_167_264_017], np.int64) * 1_000_000
_FIX_3D: Final = 3
#: Names of the fields with the GPS week and the milliseconds, in new and old logs.
_GPS_TIMES: Final = (("GWk", "GMS"), ("Week", "TimeMS"))
#: A time that is this far after the last times of other tables is from a damaged record.
_MAX_AHEAD_US: Final = 86_400_000_000


def gps_time_base(kind: RecordType, table: NDArray[Any]) -> TimeBase:
    """Return the clock of a log from its GPS records.

    Args:
        kind: The record type.
        table: Its table.

    Returns:
        UTC if a GPS record with a fix holds the time, the time since boot otherwise.
    """
    pair = next((pair for pair in _GPS_TIMES if set(pair) <= set(kind.integer_columns)), None)
    boot = boot_microseconds(kind, table)
    if pair is None or boot is None:
        return TimeBase("boot")
    week, milliseconds = (table[name].astype(np.int64) for name in pair)
    known = (week > 0) & (week <= _MAX_WEEK) & (milliseconds >= 0) & (milliseconds * 1000 < _WEEK_US)
    if "Status" in kind.integer_columns and (known & (table["Status"] >= _FIX_3D)).any():
        known &= table["Status"] >= _FIX_3D
    gps = week[known] * _WEEK_US + milliseconds[known] * 1000
    leap = _FIRST_LEAP_SECONDS + np.searchsorted(_LEAP_STEPS_US, gps, side="right")
    found = median_offset(_GPS_EPOCH_US + gps - leap * 1_000_000, boot[known])
    return (
        TimeBase("boot") if found is None else TimeBase("utc", *found, f"{kind.name} week and milliseconds")
    )


def boot_microseconds(kind: RecordType, table: NDArray[Any]) -> NDArray[np.int64] | None:
    """Return the time since boot of each row in microseconds, or None if the record type has none.

    Args:
        kind: The record type.
        table: Rows of its table.
    """
    found = kind.time_column
    if found is None:
        return None
    column, factor = found
    return table[column.name].astype(np.int64) * factor


def neighbour_seconds(table: NDArray[Any]) -> NDArray[np.float64]:
    """Return the times since boot that rows without a time have from the records beside them, or NaN.

    Args:
        table: Rows of a table whose type has no time.
    """
    if NEIGHBOUR_TIME not in (table.dtype.names or ()):
        return np.full(len(table), np.nan)
    times = np.asarray(table[NEIGHBOUR_TIME])
    return np.where(times == NO_TIME, np.nan, times / 1e6)


def times_before(
    positions: NDArray[np.int64], timed: Sequence[tuple[NDArray[np.int64], NDArray[np.int64]]]
) -> NDArray[np.int64]:
    """Return the time of the last record before each position, or else of the first after it.

    Args:
        positions: Positions in the file.
        timed: For each table with times the positions of its records, and their times.

    Returns:
        The times; `NO_TIME` if no record has one.
    """
    if not sum(len(places) for places, _ in timed):
        return np.full(len(positions), NO_TIME)
    places = np.concatenate([places for places, _ in timed])
    order = np.argsort(places)
    times = np.concatenate([times for _, times in timed])[order]
    before = np.searchsorted(places[order], positions) - 1
    found: NDArray[np.int64] = times[np.maximum(before, 0)]
    return found


def span(firsts: Sequence[int], lasts: Sequence[int]) -> tuple[int, int] | None:
    """Return the earliest and the latest time, without those of damaged records.

    Args:
        firsts: Time since boot of the first row of each table in microseconds.
        lasts: Time since boot of the last row of each table.
    """
    if not firsts:
        return None
    limit = int(np.median(lasts)) + _MAX_AHEAD_US
    plausible = [time for time in (*firsts, *lasts) if 0 <= time <= limit]
    return (min(plausible), max(plausible)) if plausible else None
