"""The clock of a ULog: the time since boot, related to UTC by satellite navigation.

A record of `vehicle_gps_position` (in later versions also `sensor_gps`) holds UTC in `time_utc_usec`, which
is that of the time `timestamp + timestamp_time_relative` since boot, or 0 while it is unknown. Without such
records `boot_time_utc_us` of the information messages is used, which the autopilot takes from its own clock.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.time_base import TimeBase, median_offset

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.ulog.entries import Value

#: Topics with UTC, in order of preference.
GPS_TOPICS: Final = ("vehicle_gps_position", "sensor_gps")
_UTC, _BOOT, _RELATIVE = "time_utc_usec", "timestamp", "timestamp_time_relative"
#: Range of valid times: a time before 2000 or after 2200 is from a receiver or a clock that is not set.
_MIN_UTC, _MAX_UTC = 946_684_800_000_000, 7_258_118_400_000_000


def time_base(tables: Iterable[Mapping[str, MessageTable]], information: Mapping[str, Value]) -> TimeBase:
    """Return the clock of a log.

    Args:
        tables: The tables of `GPS_TOPICS`, in one piece or in several.
        information: The information messages.
    """
    pairs: dict[str, list[tuple[NDArray[np.int64], NDArray[np.int64]]]] = {name: [] for name in GPS_TOPICS}
    for piece in tables:
        for name, table in piece.items():
            pairs[name].append(_pairs(table))
    for name, found in pairs.items():
        if any(len(utc) for utc, _ in found):
            utc, boot = (np.concatenate(columns) for columns in zip(*found, strict=True))
            offset = median_offset(utc, boot)
            if offset is not None:
                return TimeBase("utc", *offset, f"{name}.{_UTC}")
    boot_time = information.get("boot_time_utc_us")
    if isinstance(boot_time, int) and _MIN_UTC <= boot_time < _MAX_UTC:
        return TimeBase("utc", boot_time, None, "boot_time_utc_us")
    return TimeBase("boot")


def _pairs(table: MessageTable) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return UTC and time since boot of the rows that hold both."""
    if not table.schema.has_numbers(_UTC, _BOOT):
        return np.empty(0, np.int64), np.empty(0, np.int64)
    utc = table[_UTC].astype(np.int64)
    boot = table[_BOOT].astype(np.int64)
    if table.schema.has_numbers(_RELATIVE):
        boot = boot + table[_RELATIVE].astype(np.int64)
    known = (utc >= _MIN_UTC) & (utc < _MAX_UTC)
    return utc[known], boot[known]
