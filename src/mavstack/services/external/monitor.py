"""The rate and the age of the estimates that a program sends."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from mavstack.services.external.estimates import PoseEstimate

#: Seconds over which rate and age are measured.
WINDOW: Final = 2.0
_MAX_SAMPLES: Final = 500


class StreamMonitor:
    """Keeps the times of the last estimates."""

    def __init__(self) -> None:
        self._times: deque[tuple[float, float]] = deque(maxlen=_MAX_SAMPLES)
        self._last: PoseEstimate | None = None
        #: The number of estimates sent.
        self.sent = 0

    def add(self, measured_at: float, now: float, estimate: PoseEstimate) -> None:
        """Count an estimate of a time, both in Unix seconds."""
        self._times.append((now, now - measured_at))
        self._last = estimate
        self.sent += 1

    @property
    def parts(self) -> frozenset[str]:
        """The parts of the last estimate, such as "position" and "yaw"."""
        return frozenset() if self._last is None else self._last.parts

    @property
    def quality(self) -> int:
        """The quality of the last estimate in percent."""
        return 0 if self._last is None else self._last.quality

    def rate(self, now: float) -> float:
        """Return the estimates per second of the last seconds."""
        times = self._recent(now)
        span = times[-1][0] - times[0][0] if len(times) > 1 else 0.0
        return (len(times) - 1) / span if span > 0 else 0.0

    def delay(self, now: float) -> float | None:
        """Return the mean time in seconds from the measurement to its sending; None without one."""
        times = self._recent(now)
        return sum(age for _, age in times) / len(times) if times else None

    def _recent(self, now: float) -> list[tuple[float, float]]:
        return [each for each in self._times if now - each[0] <= WINDOW]
