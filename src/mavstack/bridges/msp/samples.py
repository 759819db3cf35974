"""The latest messages of a flight controller with their times."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeVar

if TYPE_CHECKING:
    from mavstack.msp.messages.base import MspMessage

AnyMessage = TypeVar("AnyMessage", bound="MspMessage")

#: Maximum age of a message in seconds; an older one counts as missing. The slowest poll is faster.
MAX_AGE: Final = 10.0


class Samples:
    """The latest message of each class.

    Attributes:
        now: The present time, Unix seconds, set by the owner before values are read.
        booted_at: When contact to the flight controller began, or when it last restarted.
    """

    def __init__(self) -> None:
        self.now = 0.0
        self.booted_at = 0.0
        self._latest: dict[type[MspMessage], tuple[MspMessage, float]] = {}

    def put(self, message: MspMessage, now: float) -> None:
        """Store a message that was received now."""
        self.now = now
        self._latest[type(message)] = message, now

    def get(self, kind: type[AnyMessage]) -> AnyMessage | None:
        """Return the latest message of a class; None if no message arrived or the latest is too old."""
        message, received_at = self._latest.get(kind, (None, 0.0))
        return message if isinstance(message, kind) and self.now - received_at <= MAX_AGE else None

    def time_boot_ms(self, kind: type[MspMessage] | None = None) -> int:
        """Return when the latest message of a class was received, or now, in milliseconds since the boot."""
        at = self.now if kind is None else self._latest.get(kind, (None, self.now))[1]
        return int(max(at - self.booted_at, 0.0) * 1000) & 0xFFFFFFFF

    def clear(self) -> None:
        """Forget all messages, such as those before a restart."""
        self._latest.clear()
