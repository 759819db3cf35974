"""The clocks in a log of packets: the recorder's, and of each system its time since boot and its UTC.

SYSTEM_TIME relates a system's time since boot to UTC. The recorder's clock is another one: it may be wrong by
hours, and a packet is received later than it was sent. The time since boot of a packet is a field of its
message (`time_boot_ms`, or `time_usec` where it does not hold UTC); without such a field it is the receive
time minus the median of (receive time minus boot time) over packets of the system that have one.

A system that reboots starts its clock again. Each boot has offsets of its own, which hold from the receive
time at which it began. The clock of a system is that of its component with the lowest id, normally the
autopilot.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.time_base import TimeBase, median_offset, unix_seconds

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.time_base import Clock

#: Fields that hold the time since boot, and their unit in microseconds.
_BOOT_FIELDS: Final = (("time_boot_ms", 1000), ("time_usec", 1), ("time_boot_us", 1))
#: A larger `time_usec` is UTC: 2001-09-09 in microseconds since 1970, or 31 years since boot.
_MAX_BOOT_US: Final = 10**15
#: Messages that most vehicles stream: their time since boot is compared with the receive time, in this order
#: of preference.
_COMPARED: Final = ("ATTITUDE", "GLOBAL_POSITION_INT", "SYSTEM_TIME", "VFR_HUD", "ATTITUDE_QUATERNION")
#: Minimum step back of a clock in microseconds that means a reboot; late packets cause smaller steps.
_MIN_RESTART: Final = 5_000_000
_ALWAYS: Final = np.iinfo(np.int64).min


@dataclass(frozen=True, eq=False)
class _Offsets:
    """The offset of one system's clock in microseconds, for each of its boots.

    Attributes:
        starts: Receive times in microseconds from which the offsets hold, ascending.
        offsets: The offset of each boot.
        usual: The offset of the boot with the most packets, and its uncertainty.
    """

    starts: NDArray[np.int64]
    offsets: NDArray[np.int64]
    usual: tuple[int, int]

    def at(self, times: NDArray[np.datetime64]) -> NDArray[np.float64]:
        """Return the offset at receive times in seconds; at unknown times, the usual offset."""
        positions = np.searchsorted(self.starts, times.astype("M8[us]").astype(np.int64), side="right") - 1
        offsets = self.offsets[np.maximum(positions, 0)] / 1e6
        return np.where(np.isnat(times), self.usual[0] / 1e6, offsets)


class PacketClocks:
    """The clocks of the systems in a log of packets.

    Args:
        log: The log, or a view of it.
    """

    def __init__(self, log: Log) -> None:
        self._log = log

    def time_base(self, kind: Clock) -> TimeBase:
        """Return the clock of the log, and the offset of the system with the lowest id.

        Args:
            kind: The clock of the column `_time`, or "boot" without times.
        """
        if self._utc_offsets:
            offset, uncertainty = self._utc_offsets[min(self._utc_offsets)].usual
            return TimeBase(kind, offset, uncertainty, "SYSTEM_TIME")
        if self._receive_offsets:
            offset, uncertainty = self._receive_offsets[min(self._receive_offsets)].usual
            return TimeBase(kind, offset, uncertainty, "receive time")
        return TimeBase(kind)

    def boot_times(self, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the time since boot of each row in seconds, NaN where unknown; None if all are.

        Args:
            table: Rows of a message.
        """
        recorded = boot_microseconds(table)
        times = np.full(len(table), np.nan) if recorded is None else recorded / 1e6
        missing = np.isnan(times)
        if missing.any():
            offsets = _by_system(table, self._receive_offsets)
            times[missing] = (unix_seconds(table["_time"]) - offsets)[missing]
        return None if len(times) and np.isnan(times).all() else times

    def utc_times(self, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the UTC of each row in seconds since 1970, by its system's clock or else the recorder's.

        Args:
            table: Rows of a message.
        """
        boot, times = self.boot_times(table), unix_seconds(table["_time"])
        if boot is not None:
            known = boot + _by_system(table, self._utc_offsets)
            times = np.where(np.isnan(known), times, known)
        return None if len(times) and np.isnan(times).all() else times

    @cached_property
    def _utc_offsets(self) -> dict[int, _Offsets]:
        """UTC minus time since boot, by system."""
        table = self._log.get("SYSTEM_TIME")
        if table is None:
            return {}
        table = table.where(table["time_unix_usec"] > _MAX_BOOT_US)
        boot = table["time_boot_ms"].astype(np.int64) * 1000
        return _offsets_by_system(table, table["time_unix_usec"], boot)

    @cached_property
    def _receive_offsets(self) -> dict[int, _Offsets]:
        """Receive time minus time since boot, by system."""
        offsets: dict[int, _Offsets] = {}
        for name in (name for name in _COMPARED if name in self._log):
            table = self._log[name]
            boot = boot_microseconds(table)
            if boot is None:
                continue
            known = ~np.isnat(table["_time"]) & ~np.isnan(boot)
            rows, received = table.where(known), table["_time"][known].astype(np.int64)
            offsets = _offsets_by_system(rows, received, boot[known].astype(np.int64)) | offsets
        return offsets


def boot_microseconds(table: MessageTable) -> NDArray[np.float64] | None:
    """Return the time since boot that rows hold, NaN where it is UTC; None without such a field.

    Args:
        table: Rows of a message.
    """
    for name, factor in _BOOT_FIELDS:
        if name in (table.dtype.names or ()) and table.dtype[name].kind == "u":
            values = table[name].astype(np.float64) * factor
            values[values > _MAX_BOOT_US] = np.nan
            return values
    return None


def _offsets_by_system(
    table: MessageTable, utc_us: NDArray[np.integer], boot_us: NDArray[np.integer]
) -> dict[int, _Offsets]:
    systems, components = table["_system"], table["_component"]
    found = {}
    for system in np.unique(systems).tolist():
        mine = systems == system
        mine &= components == components[mine].min()
        found[system] = _offsets_of(table["_time"][mine], utc_us[mine], boot_us[mine])
    return found


def _offsets_of(
    times: NDArray[np.datetime64], utc_us: NDArray[np.integer], boot_us: NDArray[np.integer]
) -> _Offsets:
    """Return the offsets of a clock from packets in the order of the file, at least one."""
    boot = boot_us.astype(np.int64)
    differences = utc_us.astype(np.int64) - boot
    restarts = (np.diff(boot) < -_MIN_RESTART) & (np.diff(differences) > _MIN_RESTART)
    firsts = [0, *(np.flatnonzero(restarts) + 1).tolist()] if not np.isnat(times).any() else [0]
    parts = [slice(first, last) for first, last in zip(firsts, [*firsts[1:], len(boot)], strict=True)]
    medians = [found for part in parts if (found := median_offset(utc_us[part], boot[part])) is not None]
    starts = times.astype("M8[us]").astype(np.int64)[firsts] - boot[firsts]
    starts[0] = _ALWAYS
    best = max(range(len(parts)), key=lambda number: parts[number].stop - parts[number].start)
    offsets = np.array([offset for offset, _ in medians], np.int64)
    return _Offsets(np.maximum.accumulate(starts), offsets, medians[best])


def _by_system(table: MessageTable, offsets: dict[int, _Offsets]) -> NDArray[np.float64]:
    """Return the offset of each row's system in seconds, NaN where it is not known."""
    values = np.full(len(table), np.nan)
    for system, each in offsets.items():
        mine = table["_system"] == system
        values[mine] = each.at(table["_time"][mine])
    return values
