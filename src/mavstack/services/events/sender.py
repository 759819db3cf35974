"""The sender of a component's events.

The sender does not know its receivers. It keeps the last events, and answers a request for a range with one
answer per number, at most as many as it keeps: a longer range, whose older part is gone, begins with one
error that names the oldest event kept. The answers wait until the link to the receiver has room; those of
requests beyond a bound are dropped, since a receiver requests again.
"""

from __future__ import annotations

from collections import deque
from enum import IntEnum
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import BROADCAST, Address, message_ids
from mavstack.services.events.sequence import NUMBERS, after, distance
from mavstack.services.service import Outgoing, Priority
from mavstack.services.stream_sender import StreamSender

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.service import HasRoom
    from mavstack.wire import Packet

#: Seconds between two CURRENT_EVENT_SEQUENCE.
SEQUENCE_INTERVAL: Final = 3.0
DEFAULT_CAPACITY: Final = 20
MAX_ARGUMENTS: Final = 40
#: The number before the first event: numbers wrap to 0 soon, so that receivers that cannot handle this are
#: noticed.
_INITIAL: Final = NUMBERS - 11
_MAX_TIME_MS: Final = 0xFFFFFFFF
#: The largest number of waiting answers, as a multiple of the capacity.
_MAX_WAITING: Final = 4


class LogLevel(IntEnum):
    """Level of an event: MAV_SEVERITY, and two levels more."""

    EMERGENCY = 0
    ALERT = 1
    CRITICAL = 2
    ERROR = 3
    WARNING = 4
    NOTICE = 5
    INFO = 6
    DEBUG = 7
    PROTOCOL = 8  # for programs, not shown to users
    DISABLED = 9


class EventSender(StreamSender):
    """The sender that numbers and broadcasts events, and repeats them on request.

    Args:
        local: The address of the component.
        started_at: Unix time of its boot.
        capacity: Number of events that it keeps.
        interval: Seconds between two CURRENT_EVENT_SEQUENCE.
    """

    handles = message_ids(common.RequestEvent)

    def __init__(
        self,
        local: Address,
        started_at: float,
        *,
        capacity: int = DEFAULT_CAPACITY,
        interval: float = SEQUENCE_INTERVAL,
    ) -> None:
        super().__init__(local, BROADCAST, 1.0 / interval)
        self._started_at = started_at
        self._capacity = capacity
        #: The number of the newest event.
        self.latest = _INITIAL
        self._kept: dict[int, common.Event] = {}
        self._answers: deque[tuple[Address, int]] = deque(maxlen=_MAX_WAITING * capacity)
        self.start(started_at)

    def report(
        self,
        event_id: int,
        now: float,
        *,
        arguments: bytes = b"",
        level: LogLevel = LogLevel.INFO,
        internal_level: LogLevel | None = None,
    ) -> int:
        """Broadcast an event.

        Args:
            event_id: The id: the component id of the namespace in the highest byte, and 24 bits.
            now: Unix time in seconds.
            arguments: The arguments, little-endian and without padding.
            level: The level for ground stations.
            internal_level: The level for logs; None for `level`.

        Returns:
            The sequence number of the event.

        Raises:
            InvalidArgumentError: There are more than 40 bytes of arguments.
        """
        if len(arguments) > MAX_ARGUMENTS:
            raise InvalidArgumentError(
                f"an event has at most {MAX_ARGUMENTS} bytes of arguments, got {len(arguments)}"
            )
        self.latest = after(self.latest)
        event = common.Event(
            id=event_id,
            event_time_boot_ms=max(round((now - self._started_at) * 1000), 0) & _MAX_TIME_MS,
            sequence=self.latest,
            log_levels=(level if internal_level is None else internal_level) << 4 | level,
            arguments=arguments,
        )
        self._kept[self.latest] = event
        if len(self._kept) > self._capacity:
            del self._kept[next(iter(self._kept))]
        self.send(event)
        return self.latest

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.RequestEvent(first_sequence=first, last_sequence=last):
                source = Address(packet.system, packet.component)
                count = (last - first) % NUMBERS + 1
                if count > self._capacity:
                    self._answers.append((source, first))
                    first, count = after(last, 1 - self._capacity), self._capacity
                self._answers.extend((source, after(first, index)) for index in range(count))

    def current_message(self, now: float) -> common.CurrentEventSequence:
        flags = common.MavEventCurrentSequenceFlags(0)
        if not self._kept:
            flags = common.MavEventCurrentSequenceFlags.RESET
        return common.CurrentEventSequence(sequence=self.latest, flags=flags)

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        yield from super().bulk_messages(now, has_room)
        for _ in range(len(self._answers)):
            source, sequence = self._answers[0]
            if not has_room(source, Priority.STREAM):
                return
            self._answers.popleft()
            answer = self._kept.get(sequence) or self._unavailable(source, sequence)
            yield Outgoing(answer, source, Priority.STREAM)

    def _unavailable(self, source: Address, sequence: int) -> common.ResponseEventError:
        newer = (number for number in self._kept if distance(sequence, number) > 0)
        return common.ResponseEventError(
            target_system=source.system,
            target_component=source.component,
            sequence=sequence,
            sequence_oldest_available=next(newer, self.latest),
            reason=common.MavEventErrorReason.UNAVAILABLE,
        )
