"""The quick look at a sign of life: of hundreds a second nearly all tell only that their sender goes on.

A message whose time since boot fits that of the last one, a moment later, is such; nobody else has to look at
it. What does not fit (a reboot, another sender with that address) never is, and neither is the first of each
`MOMENT`, so that whoever follows the sender's lives hears of it often enough.
"""

from __future__ import annotations

MOMENT = 0.1
#: So far off may a time be, in seconds; far less than what tells two lives apart.
FITS = 1.0


class Pulse:
    """A sender that was heard, and what its next messages will tell if it goes on."""

    __slots__ = ("_ahead", "_until", "heard_at")

    def __init__(self, time_boot_ms: int, now: float) -> None:
        self.heard_at = now
        self._ahead = time_boot_ms / 1000 - now
        self._until = now + MOMENT

    def goes_on(self, time_boot_ms: int, now: float) -> bool:
        """Take in the time of a message; whether it tells nothing new."""
        if now >= self._until or not -FITS < time_boot_ms / 1000 - now - self._ahead < FITS:
            return False
        self.heard_at = now
        return True
