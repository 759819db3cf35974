"""The receiver of a component's events: in order, each once, missing ones requested.

The first packet of the sender sets the number to continue from; earlier events are not requested. Events
behind a gap wait until the gap is closed: by the requested events, by an error that says that they are gone,
or after some requests without an answer. Lost events are reported as `EventsLost`. A gap of more than
`MAX_MISSING` events is skipped up to the last ones, so memory and requests are bounded.

A sender that reboots sets the flag RESET. If that is lost, its numbers are older than the known ones: two
CURRENT_EVENT_SEQUENCE in a row with older numbers count as a reboot; or they are newer by chance: then the
time of the event is older. A RESET with an older number right behind an event is late, and means nothing. A
sender may announce its first event by a RESET with the number of that event, so that event is accepted too.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.events.sequence import NUMBERS, after, distance
from mavstack.services.service import Event, Service
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: The largest number of events that are requested.
MAX_MISSING: Final = 64
MAX_REQUESTS: Final = 8
#: Seconds until the first repetition of a request, as the guide recommends.
REQUEST_TIMEOUT: Final = 0.1
#: If CURRENT_EVENT_SEQUENCE reports an older number twice, with these seconds in between, the sender has
#: rebooted: reordered messages are closer together.
_REBOOT_DELAY: Final = 1.0
#: A newer event whose time is older by this many milliseconds shows that the sender rebooted between the two
#: events.
_REBOOT_MARGIN_MS: Final = 10_000


@dataclass(frozen=True, slots=True)
class EventReceived(Event):
    """An event of a component.

    Attributes:
        source: The component that sent it.
        sequence: Its sequence number.
        id: Its id: the component id of the namespace in the highest byte, and 24 bits.
        time_boot_ms: Milliseconds since the component booted.
        level: Level for users: MAV_SEVERITY, 8 for programs only, 9 for disabled.
        internal_level: Level for logs.
        arguments: The 40 bytes of arguments.
        time: Unix time of its reception, in seconds.
    """

    source: Address
    sequence: int
    id: int
    time_boot_ms: int
    level: int
    internal_level: int
    arguments: bytes
    time: float = field(default=0.0, compare=False)


@dataclass(frozen=True, slots=True)
class EventsLost(Event):
    """Events of a component that it could not repeat; `count` is their number."""

    source: Address
    count: int


class EventReceiver(Service):
    """The receiver of the events of one component.

    Args:
        local: The address of the local component.
        source: The component whose events are received.
    """

    handles = message_ids(common.Event, common.CurrentEventSequence, common.ResponseEventError)

    def __init__(self, local: Address, source: Address) -> None:
        super().__init__(local)
        self.source_filter = self._source = source
        #: The number of the event up to which all events were emitted or lost; None before the first packet.
        self._done: int | None = None
        self._newest = 0
        #: The newest event, and the time of its reception; None before the first event.
        self._newest_event: tuple[common.Event, float] | None = None
        #: The received events that follow a missing one, with the times of their reception.
        self._waiting: dict[int, tuple[common.Event, float]] = {}
        self._gone: set[int] = set()
        self._after_reset = False
        self._older_since: float | None = None
        self._requests = 0
        self._requested_at = 0.0
        self._due: float | None = None
        self._round_trip = RoundTrip(REQUEST_TIMEOUT, minimum=REQUEST_TIMEOUT)

    def receive(self, packet: Packet, now: float) -> bool | None:
        match packet.message:
            case common.Event() as event:
                return self._event(event, now)
            case common.CurrentEventSequence(sequence=sequence, flags=flags):
                if int(flags) & common.MavEventCurrentSequenceFlags.RESET:
                    self._reset(sequence, now)
                else:
                    self._current(sequence, now)
            case common.ResponseEventError(sequence=sequence, sequence_oldest_available=oldest):
                self._unavailable(sequence, oldest, now)
        return None

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if self._due is None or now < self._due or self._done is None:
            return
        if self._requests < MAX_REQUESTS:
            self._request(now)
            return
        self._gone.update(self._missing())
        self._advance(now)

    def _event(self, event: common.Event, now: float) -> bool | None:
        if self._done is None or self._is_from_another_boot(event):
            self._continue_from(after(event.sequence, -1))
        steps = self._steps_to(event.sequence)
        if steps == 0 and self._after_reset:
            self._after_reset = False
            self._newest_event = event, now
            self._emit(event, now)
            return None
        if steps <= 0 or event.sequence in self._waiting:
            return False
        self._after_reset, self._older_since = False, None
        if self._newest_event is None or distance(self._newest_event[0].sequence, event.sequence) > 0:
            self._newest_event = event, now
        self._extend(event.sequence)
        self._waiting[event.sequence] = event, now
        self._advance(now)
        return None

    def _is_from_another_boot(self, event: common.Event) -> bool:
        """Return whether an event has a newer number and an older time than the newest one."""
        if self._newest_event is None:
            return False
        newest = self._newest_event[0]
        older = event.event_time_boot_ms + _REBOOT_MARGIN_MS < newest.event_time_boot_ms
        return older and distance(newest.sequence, event.sequence) > 0

    def _reset(self, sequence: int, now: float) -> None:
        newest = self._newest_event
        if newest is not None and self._steps_to(sequence) < 0 and now - newest[1] < _REBOOT_DELAY:
            return
        if self._done != sequence:
            self._continue_from(sequence)
            self._after_reset = True

    def _current(self, sequence: int, now: float) -> None:
        if self._done is None:
            self._continue_from(sequence)
        steps = self._steps_to(sequence)
        if steps >= 0:
            self._older_since = None
        elif self._older_since is None:
            self._older_since = now
        elif now - self._older_since >= _REBOOT_DELAY:
            self._continue_from(after(sequence, -1))
            steps = 1
        if steps > 0:
            self._after_reset = False
            self._extend(sequence)
            self._advance(now)

    def _unavailable(self, sequence: int, oldest: int, now: float) -> None:
        if self._done is None or not 0 < self._steps_to(sequence) <= self._steps_to(self._newest):
            return
        count = min(max(distance(sequence, oldest), 1), distance(sequence, self._newest) + 1)
        self._gone.update(after(sequence, index) for index in range(count))
        self._advance(now)

    def _continue_from(self, sequence: int) -> None:
        """Take a number as that of the last event, and discard all state."""
        self._done = self._newest = sequence
        self._waiting.clear()
        self._gone.clear()
        self._newest_event = None
        self._after_reset, self._older_since = False, None
        self._requests, self._due = 0, None

    def _steps_to(self, sequence: int) -> int:
        return distance(self._done or 0, sequence)

    def _extend(self, sequence: int) -> None:
        """Expect events up to a number; skip the older ones of a gap that is too large."""
        if distance(self._newest, sequence) > 0:
            self._newest = sequence
        self._skip(self._steps_to(self._newest) - MAX_MISSING)

    def _skip(self, count: int) -> None:
        """Emit which of the next events are there, and give up the others; none if `count` is negative."""
        if count <= 0:
            return
        end = after(self._done or 0, count)
        numbers = sorted(self._waiting.keys() | self._gone, key=self._steps_to)
        skipped = [number for number in numbers if self._steps_to(number) <= count]
        received = [each for number in skipped if (each := self._waiting.pop(number, None)) is not None]
        self._gone.difference_update(skipped)
        self._done = end
        self._report_lost(count - len(received))
        for event, time in received:
            self._emit(event, time)

    def _step(self) -> int:
        """Emit the next event if it is there; return the number of lost ones: 0 or 1."""
        self._done = after(self._done or 0)
        self._gone.discard(self._done)
        received = self._waiting.pop(self._done, None)
        if received is None:
            return 1
        self._emit(*received)
        return 0

    def _advance(self, now: float) -> None:
        """Emit what is in order; request what is missing, unless a request is under way."""
        before, lost = self._done, 0
        while (following := after(self._done or 0)) in self._waiting or following in self._gone:
            if following in self._waiting:
                self._report_lost(lost)
                lost = 0
            lost += self._step()
        self._report_lost(lost)
        if self._done == self._newest:
            self._measure(now)
            self._requests, self._due = 0, None
        elif self._due is None:
            self._request(now)
        elif self._done != before:
            self._measure(now)
            self._requests, self._requested_at = 1, now
            self._due = now + self._round_trip.timeout()

    def _measure(self, now: float) -> None:
        if self._due is not None and self._requests == 1:
            self._round_trip.add_sample(now - self._requested_at)

    def _missing(self) -> list[int]:
        done = self._done or 0
        numbers = (after(done, index + 1) for index in range(self._steps_to(self._newest)))
        return [number for number in numbers if number not in self._waiting and number not in self._gone]

    def _request(self, now: float) -> None:
        missing = self._missing()
        self._requests += 1
        self._requested_at = now
        self._due = now + self._round_trip.timeout(self._requests)
        request = common.RequestEvent(
            target_system=self._source.system,
            target_component=self._source.component,
            first_sequence=missing[0],
            last_sequence=missing[-1],
        )
        self.send(request, self._source)

    def _report_lost(self, count: int) -> None:
        if count:
            self.emit(EventsLost(self._source, count))

    def _emit(self, event: common.Event, time: float) -> None:
        if not Address(event.destination_system, event.destination_component).covers(self.local):
            return
        self.emit(
            EventReceived(
                source=self._source,
                sequence=event.sequence % NUMBERS,
                id=event.id,
                time_boot_ms=event.event_time_boot_ms,
                level=event.log_levels & 0xF,
                internal_level=event.log_levels >> 4,
                arguments=bytes(event.arguments),
                time=time,
            )
        )
