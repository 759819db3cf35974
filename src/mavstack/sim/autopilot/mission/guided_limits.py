"""The limits of guided flight within a mission."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class GuidedLimits:
    """DO_GUIDED_LIMITS: seconds, metres above home, metres; 0 means no limit."""

    time: float = 0.0
    lowest: float = 0.0
    highest: float = 0.0
    distance: float = 0.0

    def reached(self, time: float, altitude: float, distance: float) -> bool:
        """Return whether any limit is reached."""
        return bool(
            (self.time > 0 and time >= self.time)
            or (self.lowest and altitude < self.lowest)
            or (self.highest and altitude > self.highest)
            or (self.distance > 0 and distance > self.distance)
        )
