"""The clocks of a log, and how well they are known.

A vehicle counts time since its boot; a receiver of satellite navigation knows UTC; a recorder on the ground
writes the time at which it received a packet. A log has one *time base*, the best clock that it holds:

- *utc*: the file relates boot time to UTC (DataFlash and ULog with GPS);
- *received*: the recorder's clock (tlogs, captures);
- *boot*: only time since boot is known.

The offset between boot time and UTC is the median over all records that hold both; its uncertainty is the
spread of these records (1.4826 times the median absolute deviation, which is the standard deviation of normal
noise).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from typing import Any

    from numpy.typing import NDArray

Clock: TypeAlias = Literal["utc", "received", "boot"]
ClockChoice: TypeAlias = Literal["auto", "utc", "received", "boot"]
CLOCKS: Final = ("auto", "utc", "received", "boot")

#: Factor from the median absolute deviation to the standard deviation of normal noise.
_DEVIATION_FACTOR: Final = 1.4826


@dataclass(frozen=True, slots=True)
class TimeBase:
    """The clock of a log.

    Attributes:
        kind: "utc", "received" or "boot"; see the head of this module.
        offset_us: UTC minus time since boot in microseconds, or None if it is not known.
        uncertainty_us: Standard deviation of the offset in microseconds, or None.
        source: Origin of the offset, such as "SYSTEM_TIME" or "GPS week and milliseconds"; empty without
            offset.
    """

    kind: Clock
    offset_us: int | None = None
    uncertainty_us: int | None = None
    source: str = ""

    def describe(self) -> str:
        """Return one line of text such as "utc; boot at 2023-11-14 22:13:20 UTC ± 1 ms (GPS)"."""
        if self.offset_us is None:
            return self.kind
        boot = str(np.datetime64(self.offset_us, "us")).replace("T", " ")[:19]
        uncertainty = "" if self.uncertainty_us is None else f" ± {self.uncertainty_us / 1000:.3g} ms"
        return f"{self.kind}; boot at {boot} UTC{uncertainty} ({self.source})"


def median_offset(
    utc_us: NDArray[np.integer[Any]], boot_us: NDArray[np.integer[Any]]
) -> tuple[int, int] | None:
    """Return the offset between two clocks, from records that hold both.

    Args:
        utc_us: UTC in microseconds since 1970.
        boot_us: Time since boot in microseconds, of the same records.

    Returns:
        Median of UTC minus boot time and its uncertainty, both in microseconds; None without records.
    """
    if not len(utc_us):
        return None
    differences = utc_us.astype(np.int64) - boot_us.astype(np.int64)
    # Relative to the first record, so that 64-bit floats keep every microsecond.
    relative = differences - differences[0]
    middle = float(np.median(relative))
    spread = float(np.median(np.abs(relative - middle))) * _DEVIATION_FACTOR
    return int(differences[0]) + round(middle), round(spread)


def unix_seconds(times: NDArray[np.datetime64]) -> NDArray[np.float64]:
    """Return times as seconds since 1970, NaN where the time is not recorded."""
    seconds = times.astype("M8[us]").astype(np.int64) / 1e6
    seconds[np.isnat(times)] = np.nan
    return seconds
