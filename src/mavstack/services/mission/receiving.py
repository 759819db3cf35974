"""The vehicle's side of uploads: asks for the items one by one and has a plan when it has them all.

A plan of each type can be on its way, from one sender at a time; another is refused until the first has ended
or was silent for `IDLE_TIMEOUT`. An item is asked for again after an adaptive time (the guide's 250 ms to begin
with), and at once if a wrong one comes. What ended stays known for a while, so that a sender who did not hear
the last acknowledgement, and sends its last item again, hears it again.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission.item import MissionItem
from mavstack.services.mission.plan import Plan
from mavstack.services.service import earliest
from mavstack.services.timing import DOUBLED_WITHIN, RoundTrip

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.services.addressing import Address

#: How long to wait for the next item, however often it was asked for.
IDLE_TIMEOUT = 8.0
#: For so long a last item that comes again is answered as it was.
MEMORY = 30.0
#: A count like the last one that comes so soon after its upload is a late one of the same upload.
LATE_COUNT = 0.3
MOST_REMEMBERED = 64
#: Before an item is asked for again: at first, and at least.
FIRST_PAUSE, ASK_AGAIN = 0.25, 0.02
#: The longest time between two requests for an item, unless the link is slower.
MOST_PAUSE = 0.5
#: After so many unanswered requests for the first item the older form is tried too.
OLD_FORM_AFTER = 2

_Result = common.MavMissionResult


@dataclass(eq=False, slots=True)
class Receiving:
    """An upload under way."""

    type: int
    source: Address
    count: int
    count_raw: bytes
    begun_at: float
    moved_at: float
    round_trip: RoundTrip
    items: list[MissionItem] = field(default_factory=list)
    tries: int = 0
    asked_at: float = 0.0
    timeout: float | None = None
    as_float: bool = False

    @property
    def due(self) -> int:
        """Which item comes next."""
        return len(self.items)

    def doubled(self, raw: bytes, now: float) -> bool:
        """Whether these bytes are the very count that it began with."""
        return self.count_raw == raw and now - self.begun_at < DOUBLED_WITHIN

    def measure(self, now: float) -> None:
        """Learn from an item that was asked for once; one that came by itself is too soon to be an answer."""
        trip, known = now - self.asked_at, self.round_trip.smoothed
        if self.tries == 1 and (known is None or trip > known / 2):
            self.round_trip.measured(trip)

    def lately_asked(self, now: float) -> bool:
        """Whether the answer to the last request may still be on its way."""
        known = self.round_trip.smoothed
        return now - self.asked_at < (0.1 if known is None else 0.7 * known)


@dataclass(frozen=True, slots=True)
class _Ended:
    count: int
    count_raw: bytes
    seq: int
    item: MissionItem | None
    result: int
    plan_id: int
    at: float

    def doubled(self, raw: bytes, now: float) -> bool:
        return self.count_raw == raw and now - self.at < DOUBLED_WITHIN


class Uploads:
    """All uploads to one vehicle.

    `complete` takes a whole plan and gives MAV_MISSION_RESULT and the plan's id; `check` judges one item;
    `reply` sends a message to someone. With `plain_requests` items are always asked for by MISSION_REQUEST.
    `ask_again` is the least time before an item is asked for again.
    """

    def __init__(
        self,
        complete: Callable[[Plan, Address], tuple[int, int]],
        check: Callable[[int, int, MissionItem], int],
        reply: Callable[[Message, Address], None],
        *,
        plain_requests: bool = False,
        ask_again: float = ASK_AGAIN,
    ) -> None:
        self._complete, self._check, self._reply = complete, check, reply
        self._plain_requests, self._ask_again = plain_requests, ask_again
        self._running: dict[int, Receiving] = {}
        self._ended: OrderedDict[tuple[Address, int], _Ended] = OrderedDict()

    def under_way(self, plan_type: int) -> Receiving | None:
        """The upload of a type that has not ended."""
        return self._running.get(plan_type)

    def begin(self, source: Address, message: common.MissionCount, raw: bytes, now: float) -> None:
        """MISSION_COUNT of someone who may upload so many items."""
        kind = int(message.mission_type)
        running, ended = self._running.get(kind), self._ended.get((source, kind))
        if running is not None and running.source != source:
            self.acknowledge(source, kind, _Result.DENIED)
        elif ended is not None and ended.count == message.count and now - ended.at < LATE_COUNT:
            return  # it was sent twice, and is asked for again if it is not this
        elif not any(known is not None and known.doubled(raw, now) for known in (running, ended)):
            self._ended.pop((source, kind), None)
            trip = RoundTrip(initial=max(FIRST_PAUSE, self._ask_again), least=self._ask_again, most=3.0)
            receiving = Receiving(kind, source, message.count, raw, now, now, trip)
            self._running[kind] = receiving
            self._go_on(receiving, now)

    def take(self, source: Address, message: common.MissionItemInt | common.MissionItem, now: float) -> None:
        """An item came."""
        kind = int(message.mission_type)
        receiving = self._running.get(kind)
        if receiving is None or receiving.source != source:
            self._take_stray(source, message, now)
        elif message.seq == receiving.due:
            receiving.as_float = isinstance(message, common.MissionItem)
            receiving.measure(now)
            self._take_due(receiving, MissionItem.read(message), now)
        elif not receiving.lately_asked(now):
            self._ask(receiving, now)

    def acknowledged(self, source: Address, message: common.MissionAck, now: float) -> None:
        """The sender gives up, or wants to be asked in the other form."""
        receiving = self._running.get(int(message.mission_type))
        if receiving is None or receiving.source != source:
            return
        if message.type == _Result.OPERATION_CANCELLED:
            self.drop(receiving.type)
            self.acknowledge(source, receiving.type, _Result.OPERATION_CANCELLED)
        elif message.type == _Result.UNSUPPORTED and not receiving.lately_asked(now):
            receiving.as_float = not receiving.as_float
            self._ask(receiving, now)

    def drop(self, plan_type: int) -> None:
        """End an upload without a word."""
        self._running.pop(plan_type, None)

    def acknowledge(self, source: Address, plan_type: int, result: int, plan_id: int = 0) -> None:
        """Send MISSION_ACK."""
        ack = common.MissionAck(
            target_system=source.system,
            target_component=source.component,
            type=result,
            mission_type=plan_type,
            opaque_id=plan_id,
        )
        self._reply(ack, source)

    def next_timeout(self) -> float | None:
        """When `handle_timeout` has something to do."""
        return earliest(*(receiving.timeout for receiving in self._running.values()))

    def handle_timeout(self, now: float) -> None:
        """Ask again for what did not come, and end what has been silent for too long."""
        for receiving in tuple(self._running.values()):
            if now - receiving.moved_at >= IDLE_TIMEOUT:
                self.drop(receiving.type)
                self.acknowledge(receiving.source, receiving.type, _Result.OPERATION_CANCELLED)
            elif receiving.timeout is not None and now >= receiving.timeout:
                if receiving.due == 0 and receiving.tries >= OLD_FORM_AFTER:
                    receiving.as_float = not receiving.as_float
                self._ask(receiving, now)

    def _take_due(self, receiving: Receiving, item: MissionItem, now: float) -> None:
        result = self._check(receiving.type, receiving.due, item)
        if result != _Result.ACCEPTED:
            self._end(receiving, item, result, 0, now)
            return
        receiving.items.append(item)
        receiving.tries, receiving.moved_at = 0, now
        self._go_on(receiving, now)

    def _go_on(self, receiving: Receiving, now: float) -> None:
        if receiving.due < receiving.count:
            self._ask(receiving, now)
            return
        result, plan_id = self._complete(Plan(receiving.type, tuple(receiving.items)), receiving.source)
        last = receiving.items.pop() if receiving.items else None
        self._end(receiving, last, result, plan_id, now)

    def _end(
        self, receiving: Receiving, item: MissionItem | None, result: int, plan_id: int, now: float
    ) -> None:
        """Answer the item that was due, or the count if there are none, for the last time."""
        self.drop(receiving.type)
        key = (receiving.source, receiving.type)
        self._ended[key] = _Ended(
            receiving.count, receiving.count_raw, receiving.due, item, result, plan_id, now
        )
        if len(self._ended) > MOST_REMEMBERED:
            self._ended.popitem(last=False)
        self.acknowledge(receiving.source, receiving.type, result, plan_id)

    def _take_stray(
        self, source: Address, message: common.MissionItemInt | common.MissionItem, now: float
    ) -> None:
        kind = int(message.mission_type)
        ended = self._ended.get((source, kind))
        known = ended is not None and now - ended.at < MEMORY and ended.seq == message.seq
        if ended is not None and known and ended.item == MissionItem.read(message):
            self.acknowledge(source, kind, ended.result, ended.plan_id)
        elif ended is None or now - ended.at >= MEMORY or message.seq > ended.seq:
            self.acknowledge(source, kind, _Result.ERROR)

    def _ask(self, receiving: Receiving, now: float) -> None:
        plain = self._plain_requests or receiving.as_float
        kind = common.MissionRequest if plain else common.MissionRequestInt
        request = kind(
            target_system=receiving.source.system,
            target_component=receiving.source.component,
            seq=receiving.due,
            mission_type=receiving.type,
        )
        receiving.tries += 1
        receiving.asked_at = now
        once = receiving.round_trip.timeout()
        again = now + min(receiving.round_trip.timeout(receiving.tries), max(MOST_PAUSE, 2 * once))
        receiving.timeout = min(again, max(receiving.moved_at + IDLE_TIMEOUT, now + 0.001))
        self._reply(request, receiving.source)
