"""Several logs of one flight on one timeline.

The radio link's tlog has the clock of the ground station; the vehicle's own log has the time since boot, and
relates it to UTC by its GPS. Each log is put on the timeline by its own GPS time (SYSTEM_TIME, GPS week and
milliseconds, `time_utc_usec`). Where both logs hold the same fixes, their times show what remains between the
logs: a remainder of more than a second, or a log without GPS time, is corrected by it. A log that has
neither is refused, because a guess would show causes after their effects.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError, LogError
from mavstack.logs.gps_fixes import gps_fixes
from mavstack.logs.merged_log import MergedLog
from mavstack.logs.merged_source import LogOffset, MergedSource
from mavstack.logs.time_base import median_offset, unix_seconds

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.logs.time_base import Clock

#: Minimum number of common fixes for a comparison.
_MIN_MATCHES: Final = 5
#: Maximum remaining difference in seconds between the GPS times of two logs.
_MAX_REMAINDER: Final = 1.0


@dataclass(frozen=True, slots=True)
class _Fixes:
    keys: NDArray[np.int64]
    times: NDArray[np.float64]


def merge_logs(*logs: Log) -> MergedLog:
    """Return several logs of one flight as one log on one timeline.

    Args:
        logs: The logs, such as a tlog and the .BIN or .ulg of the vehicle. The first of those with the best
            clock is the reference.

    Returns:
        The merged log; its `offsets` say by how much the times of each log were shifted, and how well that is
        known.

    Raises:
        InvalidArgumentError: There are fewer than two logs.
        LogError: The clock of a log cannot be related to that of the reference, or a log overlaps with none.
    """
    if len(logs) < 2:
        raise InvalidArgumentError(f"merging needs at least two logs, got {len(logs)}")
    reference = min(logs, key=_clock_rank)
    clock = _clock_of(reference)
    fixes = _fixes(reference, clock)
    labels = _labels(logs)
    sources = [_source(log, label, reference, fixes, clock) for log, label in zip(logs, labels, strict=True)]
    _require_overlap(sources)
    return MergedLog(sources, "utc" if has_gps_time(reference) else reference.clock)


def _require_overlap(sources: Sequence[MergedSource]) -> None:
    """Raise if a log shares no time with any other: such logs are not of one flight."""
    spans = [(source, span) for source in sources if (span := source.timeline_span()) is not None]
    for source, (first, last) in spans:
        others = [other for other in spans if other[0] is not source]
        if others and not any(start <= last and first <= end for _, (start, end) in others):
            other, span = others[0]
            raise LogError(
                f"cannot merge {source.log.path} with {other.log.path}: they do not overlap: "
                f"the first is from {_period(first, last)}, the second from {_period(*span)}; "
                "merge logs of one flight"
            )


def _period(first: float, last: float) -> str:
    start, end = (str(np.datetime64(round(seconds), "s")).replace("T", " ") for seconds in (first, last))
    return f"{start} to {end} UTC"


def has_gps_time(log: Log) -> bool:
    """Return whether a log relates its times to UTC by satellite navigation, not by the clock of a recorder.

    Args:
        log: The log.
    """
    base = log.time_base
    return base.kind == "utc" or (base.offset_us is not None and base.source != "receive time")


def _clock_rank(log: Log) -> tuple[bool, bool, bool]:
    """Order logs by their clock: the vehicle's own with GPS, then a recorder's, then boot time alone."""
    return not has_gps_time(log), log.clock == "boot", log.clock == "received"


def _clock_of(log: Log) -> Clock:
    return "utc" if has_gps_time(log) else log.clock


def _source(log: Log, label: str, reference: Log, fixes: _Fixes, reference_clock: Clock) -> MergedSource:
    clock = _clock_of(log)
    if log is reference:
        return MergedSource(log, clock, 0.0, LogOffset(label, 0, 0, "reference", 0))
    remainder = _remainder(fixes, _fixes(log, clock))
    shares_clock = clock == "utc" and reference_clock == "utc"
    if remainder is not None and not (shares_clock and abs(remainder[0]) <= _MAX_REMAINDER * 1e6):
        offset, uncertainty, matches = remainder
        return MergedSource(
            log,
            clock,
            offset / 1e6,
            _offset(log, label, clock, offset, uncertainty, "GPS positions", matches),
        )
    if shares_clock:
        spread = _combined(log.time_base.uncertainty_us, reference.time_base.uncertainty_us)
        difference, matches = (0, 0) if remainder is None else (abs(remainder[0]), remainder[2])
        if remainder is not None:
            spread = max(spread or 0, difference)
        return MergedSource(log, clock, 0.0, _offset(log, label, clock, 0, spread, "GPS time", matches))
    raise LogError(
        f"cannot merge {log.path} with {reference.path}: one has no GPS time, and they have "
        f"fewer than {_MIN_MATCHES} positions in common"
    )


def _fixes(log: Log, clock: Clock) -> _Fixes:
    return _Fixes(*gps_fixes(log, clock))


def _remainder(reference: _Fixes, other: _Fixes) -> tuple[int, int, int] | None:
    """Return reference time minus the other log's in µs, its uncertainty, and the number of common fixes."""
    _, ours, theirs = np.intersect1d(reference.keys, other.keys, assume_unique=True, return_indices=True)
    if len(ours) < _MIN_MATCHES:
        return None
    microseconds = [
        np.rint(times * 1e6).astype(np.int64) for times in (reference.times[ours], other.times[theirs])
    ]
    found = median_offset(*microseconds)
    return None if found is None else (*found, len(ours))


def _combined(*uncertainties: int | None) -> int | None:
    """Return the uncertainty of a difference, or None if one is not known."""
    known = [value for value in uncertainties if value is not None]
    return round(float(np.hypot.reduce(known))) if len(known) == len(uncertainties) else None


def _offset(
    log: Log, label: str, clock: Clock, shift: int, uncertainty: int | None, source: str, matches: int
) -> LogOffset:
    """Return by how much the recorded times of a log are shifted: `_time`, or the times since boot."""
    own = _gps_correction(log) if clock == "utc" and log.clock == "received" else 0
    return LogOffset(label, own + shift, uncertainty, source, matches)


def _gps_correction(log: Log) -> int:
    """Return GPS time minus the recorder's clock in microseconds, as the median over the longest table."""
    name = max(log.counts, key=lambda name: log.counts[name])
    table = log[name]
    times = log.utc_times(name, table)
    difference = np.empty(0) if times is None else times - unix_seconds(table["_time"])
    difference = difference[~np.isnan(difference)]
    return round(float(np.median(difference)) * 1e6) if len(difference) else 0


def _labels(logs: tuple[Log, ...]) -> list[str]:
    """Return a distinct name for each log: its format, with a number if several have it."""
    labels: list[str] = []
    for log in logs:
        count = sum(label.split(" ")[0] == log.format for label in labels)
        labels.append(f"{log.format} {count + 1}" if count else log.format)
    return labels
