"""Telling people something: the vehicle's side of STATUSTEXT."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import EVERYBODY, Address
from mavstack.services.service import HasRoom, Outgoing, Priority, Service, always_room
from mavstack.services.statustext.chunks import chunks_of, next_number

if TYPE_CHECKING:
    from collections.abc import Iterator

MOST_WAITING = 64


class StatustextSender(Service):
    """Sends texts to everybody, in order; on a full link they wait, and of too many the oldest is dropped."""

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self.dropped = 0
        self._number = 0
        self._waiting: deque[deque[common.Statustext]] = deque()
        self._begun: deque[common.Statustext] = deque()

    def say(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        """Send a text."""
        following = next_number(self._number)
        chunks = deque(chunks_of(text, severity, following))
        if len(chunks) > 1:
            self._number = following
        self._waiting.append(chunks)
        if len(self._waiting) > MOST_WAITING:
            self._waiting.popleft()
            self.dropped += 1

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        while self._begun or self._waiting:
            if not has_room(EVERYBODY, Priority.STREAM):
                return
            if not self._begun:
                self._begun = self._waiting.popleft()
            yield Outgoing(self._begun.popleft(), EVERYBODY, Priority.STREAM)
