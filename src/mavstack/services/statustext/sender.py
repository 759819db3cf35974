"""The sender of status texts."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import BROADCAST, Address
from mavstack.services.service import HasRoom, Outgoing, Priority, Service, always_room
from mavstack.services.statustext.chunks import chunks_of, next_number

if TYPE_CHECKING:
    from collections.abc import Iterator

MAX_WAITING = 64


class StatustextSender(Service):
    """The sender that broadcasts texts in order; on a full link they wait, and the oldest is dropped."""

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self.dropped = 0
        self._number = 0
        self._waiting: deque[deque[common.Statustext]] = deque()
        self._current: deque[common.Statustext] = deque()

    def send_text(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        """Send a text with a MAV_SEVERITY."""
        following = next_number(self._number)
        chunks = deque(chunks_of(text, severity, following))
        if len(chunks) > 1:
            self._number = following
        self._waiting.append(chunks)
        if len(self._waiting) > MAX_WAITING:
            self._waiting.popleft()
            self.dropped += 1

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        while self._current or self._waiting:
            if not has_room(BROADCAST, Priority.STREAM):
                return
            if not self._current:
                self._current = self._waiting.popleft()
            yield Outgoing(self._current.popleft(), BROADCAST, Priority.STREAM)
