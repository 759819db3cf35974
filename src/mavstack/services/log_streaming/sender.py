"""The vehicle's side of log streaming: one client at a time receives the log.

The header and the definitions go one block at a time, each until it is acknowledged; without an answer the
stream ends. PX4 repeats a block each 50 ms, which floods a slow link, so here the interval follows the round
trip. Records follow as fast as the link has room; while it has none, the oldest blocks are dropped, whose
numbers are missing at the receiver.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.log_streaming.framing import (
    BLOCK_SIZE,
    HEADER_SIZE,
    MAGIC,
    NO_START,
    SEQUENCES,
    message_starts,
)
from mavstack.services.service import Event, HasRoom, Outgoing, Priority, Service, always_room

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.services.command import CommandRequest, CommandServer
    from mavstack.wire import Packet

#: Seconds until a block is sent again for the first time.
ACK_TIMEOUT: Final = 0.05
#: The longest time until a block is sent again, in seconds.
MAX_ACK_TIMEOUT: Final = 0.5
#: The factor by which this time grows with each repetition.
_GROWTH: Final = 1.5
#: The largest number of times a block is sent.
MAX_TRIES: Final = 25
#: The largest number of blocks that wait for room on the link; then the oldest is dropped.
MAX_WAITING: Final = 256


@dataclass(frozen=True, slots=True)
class LogStreamStarted(Event):
    """A client asked for the log: write the header and the definitions, then the records."""

    client: Address


@dataclass(frozen=True, slots=True)
class LogStreamStopped(Event):
    """The stream ended; `reason` is empty if the client ended it."""

    reason: str = ""


class _Block(NamedTuple):
    sequence: int
    data: bytes
    first: int


class LogStreamSender(Service):
    """Streams the log of one component."""

    handles = message_ids(common.LoggingAck)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        #: The client; None while nothing is streamed.
        self.client: Address | None = None
        #: The number of blocks that were dropped because the link had no room.
        self.dropped = 0
        self._touch: Callable[[Service], object] = lambda _: None
        self._partial = bytearray()
        self._starts: list[int] = []
        self._sequence = 0
        self._acked: deque[_Block] = deque()
        self._waiting: deque[_Block] = deque()
        self._due: float | None = None
        self._tries = 0
        self._interval = ACK_TIMEOUT
        self._sent_at = 0.0

    def answer_commands(self, commands: CommandServer, touch: Callable[[Service], object]) -> None:
        """Answer MAV_CMD_LOGGING_START and MAV_CMD_LOGGING_STOP.

        Args:
            commands: The command server of the component.
            touch: Schedules this service, which has events after a command.
        """
        self._touch = touch
        commands.support(common.MavCmd.LOGGING_START, self._start)
        commands.support(common.MavCmd.LOGGING_STOP, self._stop)

    def write(self, data: bytes, now: float, *, acknowledged: bool = False) -> None:
        """Append complete messages of the log.

        Args:
            data: The messages; the first ones begin with the file header.
            now: The time.
            acknowledged: They are the header and the definitions, which must all arrive.
        """
        if self.client is None:
            return
        start = HEADER_SIZE if data.startswith(MAGIC) else 0
        self._starts += [len(self._partial) + each for each in message_starts(data, start)]
        self._partial += data
        while len(self._partial) >= BLOCK_SIZE or (self._partial and acknowledged):
            self._cut(acknowledged=acknowledged)
        if self._acked and self._due is None:
            self._due, self._tries = now, 0

    def flush(self) -> None:
        """Send what does not fill a block yet."""
        if self._partial:
            self._cut(acknowledged=False)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.LoggingAck(sequence=sequence):
                is_due = self._acked and self._acked[0].sequence == sequence
                if is_due and self.client == (packet.system, packet.component):
                    self._acked.popleft()
                    if self._tries == 1:
                        self._interval = min(max(2 * (now - self._sent_at), ACK_TIMEOUT), MAX_ACK_TIMEOUT)
                    self._due, self._tries = (now if self._acked else None), 0

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        while self.client is not None and self._waiting and not self._acked:
            if not has_room(self.client, Priority.BULK):
                return
            message = self._message(common.LoggingData, self._waiting.popleft())
            yield Outgoing(message, self.client, Priority.BULK)

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if self._due is None or now < self._due or self.client is None:
            return
        if self._tries >= MAX_TRIES:
            self._end("the client does not acknowledge the definitions")
            return
        if self._tries:
            self._interval = min(self._interval * _GROWTH, MAX_ACK_TIMEOUT)
        self._tries += 1
        self._sent_at, self._due = now, now + self._interval
        self.send(self._message(common.LoggingDataAcked, self._acked[0]), self.client)

    def _cut(self, *, acknowledged: bool) -> None:
        data = bytes(self._partial[:BLOCK_SIZE])
        starts = [start for start in self._starts if start < len(data)]
        block = _Block(self._sequence, data, starts[0] if starts else NO_START)
        self._sequence = (self._sequence + 1) % SEQUENCES
        self._starts = [start - len(data) for start in self._starts[len(starts) :]]
        del self._partial[:BLOCK_SIZE]
        if acknowledged:
            self._acked.append(block)
            return
        self._waiting.append(block)
        while len(self._waiting) > MAX_WAITING:
            self._waiting.popleft()
            self.dropped += 1

    def _message(
        self, kind: type[common.LoggingData | common.LoggingDataAcked], block: _Block
    ) -> common.LoggingData | common.LoggingDataAcked:
        system, component = self.client or (0, 0)
        return kind(
            target_system=system,
            target_component=component,
            sequence=block.sequence,
            length=len(block.data),
            first_message_offset=block.first,
            data=block.data,
        )

    def _start(self, request: CommandRequest) -> common.MavResult:
        if request.command.param1 != 0:  # 0 is the ULog format
            return common.MavResult.UNSUPPORTED
        if self.client is not None and self.client != request.source:
            return common.MavResult.TEMPORARILY_REJECTED
        self._reset()
        self.client = request.source
        self.emit(LogStreamStarted(request.source))
        self._touch(self)
        return common.MavResult.ACCEPTED

    def _stop(self, request: CommandRequest) -> common.MavResult:
        if self.client is None:
            return common.MavResult.ACCEPTED
        if self.client != request.source:
            return common.MavResult.DENIED
        self._end("")
        return common.MavResult.ACCEPTED

    def _end(self, reason: str) -> None:
        self._reset()
        self.client = None
        self.emit(LogStreamStopped(reason))
        self._touch(self)

    def _reset(self) -> None:
        self._partial.clear()
        self._starts.clear()
        self._acked.clear()
        self._waiting.clear()
        self._sequence, self._due, self._tries, self.dropped = 0, None, 0, 0
        self._interval = ACK_TIMEOUT
