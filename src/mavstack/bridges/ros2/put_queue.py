"""Samples that are put on Zenoh together at the end of a turn of the event loop.

A read brings many messages. The sending thread of Zenoh wakes for the first sample, so samples that are put
one after the other without conversions between them share its work: a fifth less processor time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    #: Called to publish a payload with its attachment.
    Put = Callable[[bytes, bytes], object]


class PutQueue:
    """The samples of one turn, in their order.

    Args:
        schedule: Calls a function at the end of the turn (`loop.call_soon`).
    """

    def __init__(self, schedule: Callable[[Callable[[], None]], object]) -> None:
        self._schedule = schedule
        self._items: list[tuple[Put, bytes, bytes]] = []

    def add(self, put: Put, payload: bytes, attachment: bytes) -> None:
        """Put a sample at the end of the turn."""
        if not self._items:
            self._schedule(self.flush)
        self._items.append((put, payload, attachment))

    def flush(self) -> None:
        """Put the samples that wait."""
        items, self._items = self._items, []
        for put, payload, attachment in items:
            put(payload, attachment)

    def clear(self) -> None:
        """Discard the samples that wait, for a session that closes."""
        self._items.clear()
