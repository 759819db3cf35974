"""The listing of all instances of a message: storages, video streams, gimbals, attached cameras.

    all requested (index 0) ── messages arrive ── as many as they say ──────────────► result
                                  └── silence ── missing ones requested by index ──► result
                                                   └── still missing after MAX_ROUNDS ──► result

Where the messages do not say how many there are, silence ends the listing. It runs on the target's
`CommandClient`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.errors import MessageTimeout
from mavstack.services.message_request.client import RequestMessage
from mavstack.services.message_request.interval import message_id_of, name_of
from mavstack.services.operation import Operation

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.wire import Packet

#: Seconds without a message after which missing messages are requested, or the listing ends.
IDLE_TIMEOUT = 1.0
MAX_ROUNDS = 4
#: Ids of instances have one byte; 0 means all instances.
ALL, MAX_INSTANCES = 0.0, 255
AnyMessage = TypeVar("AnyMessage", bound="Message")


class ListInstances(Operation["dict[int, AnyMessage]"]):
    """The listing of all instances of a message; the result are the messages by index or id.

    Args:
        message: The message class.
        index: Returns the index or id of a message.
        total: Returns how many instances there are, numbered from 1; None: the messages do not say it.
        timeout: Seconds for the whole operation; None sets no overall limit.
    """

    timeout_error = MessageTimeout

    def __init__(
        self,
        message: type[AnyMessage],
        index: Callable[[AnyMessage], int],
        total: Callable[[AnyMessage], int] | None = None,
        *,
        timeout: float | None = None,
    ) -> None:
        super().__init__(f"listing {name_of(message)} of", timeout=timeout, idle_timeout=30.0)
        self._message, self._index, self._total = message, index, total
        self._id = message_id_of(message)
        self.handles = frozenset({self._id})
        self._found: dict[int, AnyMessage] = {}
        self._expected: int | None = None
        self._rounds = 0
        self._pending: set[Operation[Any]] = set()

    def start(self, now: float) -> None:
        self._request(ALL, now)

    def receive(self, packet: Packet, now: float) -> None:
        if packet.message_id != self._id:
            return
        message: AnyMessage = packet.message
        number = self._index(message)
        if len(self._found) < MAX_INSTANCES or number in self._found:
            self._found[number] = message
        if self._total is not None:
            self._expected = self._total(message)
        self.report_progress(now)
        self.timer = now + IDLE_TIMEOUT
        if self._expected is not None and not self._missing():
            self._end()

    def handle_timeout(self, now: float) -> None:
        missing = self._missing()
        if not missing or self._rounds >= MAX_ROUNDS:
            self._end()
            return
        self._rounds += 1
        self.timer = now + IDLE_TIMEOUT * 2**self._rounds
        for number in missing:
            self._request(float(number), now)

    def child_ended(self, child: Operation[Any], now: float) -> None:
        self._pending.discard(child)
        self.attempts = max(self.attempts, child.attempts)
        if self.done or self._found or self._pending or child.error is None:
            return
        if isinstance(child.error, MessageTimeout):
            self.time_out(now)
        else:
            self.fail(child.error)

    def _missing(self) -> list[int]:
        expected = min(self._expected or 0, MAX_INSTANCES)
        return [number for number in range(1, expected + 1) if number not in self._found]

    def _request(self, number: float, now: float) -> None:
        match = None if number == ALL else lambda message: self._index(message) == number
        self._pending.add(self.begin(RequestMessage(self._message, (number,), match=match), now))

    def _end(self) -> None:
        self.finish({number: self._found[number] for number in sorted(self._found)})
