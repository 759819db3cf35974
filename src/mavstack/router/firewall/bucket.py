"""A token bucket, as the engine has for rules with a rate, for the packets that are decided in Python."""

from __future__ import annotations


class TokenBucket:
    """Lets `rate` packets per second pass, and as many at once.

    Args:
        rate: Packets per second.
        now: Time in seconds.
    """

    def __init__(self, rate: float, now: float) -> None:
        self._rate = rate
        self._burst = max(1.0, rate)
        self._tokens = self._burst
        self._filled = now

    def take(self, now: float) -> bool:
        """Take a token.

        Args:
            now: Time in seconds.

        Returns:
            True if there was one.
        """
        self._tokens = min(self._burst, self._tokens + max(0.0, now - self._filled) * self._rate)
        self._filled = max(now, self._filled)
        if self._tokens < 1.0:
            return False
        self._tokens -= 1.0
        return True
