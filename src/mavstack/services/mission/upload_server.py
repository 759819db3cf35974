"""The vehicle's side of uploads: requests the items one by one until the plan is complete.

There can be one upload per plan type, from one client; another client is refused until the first upload has
ended or was silent for `IDLE_TIMEOUT` seconds. An item is requested again after an adaptive timeout (the
guide's 250 ms at first), and at once if a wrong one arrives. Ended uploads are remembered for a while, so
that a client which missed the last acknowledgement, and sends its last item again, gets it again.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission.item import MissionItem
from mavstack.services.mission.plan import Plan
from mavstack.services.service import earliest
from mavstack.services.timing import DUPLICATE_WINDOW, RoundTrip

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.services.addressing import Address

#: Seconds without the next item after which an upload ends, independent of the number of requests.
IDLE_TIMEOUT = 8.0
#: Seconds for which the repeated last item of an ended upload gets the same answer again.
ENDED_UPLOAD_LIFETIME = 30.0
#: Seconds after an upload in which a MISSION_COUNT with the same count is a late duplicate.
LATE_COUNT_WINDOW = 0.3
MAX_REMEMBERED = 64
#: The timeout of the first request for an item, and the smallest timeout, seconds.
INITIAL_TIMEOUT, MIN_TIMEOUT = 0.25, 0.02
#: The longest time between two requests for an item, unless the link is slower, seconds.
MAX_TIMEOUT = 0.5
#: The number of unanswered MISSION_REQUEST_INT for the first item after which MISSION_REQUEST is tried too.
LEGACY_REQUEST_AFTER = 2

_Result = common.MavMissionResult


@dataclass(eq=False, slots=True)
class Upload:
    """A running upload."""

    type: int
    source: Address
    count: int
    count_raw: bytes
    begun_at: float
    progress_at: float
    round_trip: RoundTrip
    items: list[MissionItem] = field(default_factory=list)
    tries: int = 0
    requested_at: float = 0.0
    request_at: float | None = None
    as_float: bool = False
    #: True while the program stores the complete plan.
    storing: bool = False

    @property
    def due(self) -> int:
        """The number of the next item."""
        return len(self.items)

    def is_duplicate(self, raw: bytes, now: float) -> bool:
        """Return whether these bytes are the count that began the upload."""
        return self.count_raw == raw and now - self.begun_at < DUPLICATE_WINDOW

    def measure(self, now: float) -> None:
        """Add the round trip of an item that was requested once, unless it came too soon to be the answer."""
        trip, known = now - self.requested_at, self.round_trip.smoothed
        if self.tries == 1 and (known is None or trip > known / 2):
            self.round_trip.add_sample(trip)

    def was_just_requested(self, now: float) -> bool:
        """Return whether the answer to the last request may still be in transit."""
        known = self.round_trip.smoothed
        return now - self.requested_at < (0.1 if known is None else 0.7 * known)


@dataclass(frozen=True, slots=True)
class _Ended:
    count: int
    count_raw: bytes
    seq: int
    item: MissionItem | None
    result: int
    plan_id: int
    at: float

    def is_duplicate(self, raw: bytes, now: float) -> bool:
        return self.count_raw == raw and now - self.at < DUPLICATE_WINDOW


class UploadServer:
    """The uploads to one vehicle.

    Args:
        complete: Stores a complete plan; returns its MAV_MISSION_RESULT and its id, or None if that takes a
            while and ends by `finish`.
        check: Validates one item; returns a MAV_MISSION_RESULT.
        reply: Sends a message to an address.
        plain_requests: Always request items by MISSION_REQUEST.
        request_interval: The smallest time between two requests for an item, seconds.
    """

    def __init__(
        self,
        complete: Callable[[Plan, Address], tuple[int, int] | None],
        check: Callable[[int, int, MissionItem], int],
        reply: Callable[[Message, Address], None],
        *,
        plain_requests: bool = False,
        request_interval: float = MIN_TIMEOUT,
    ) -> None:
        self._complete, self._check, self._reply = complete, check, reply
        self._plain_requests, self._request_interval = plain_requests, request_interval
        self._running: dict[int, Upload] = {}
        self._ended: OrderedDict[tuple[Address, int], _Ended] = OrderedDict()

    def running(self, plan_type: int) -> Upload | None:
        """Return the running upload of a type."""
        return self._running.get(plan_type)

    def begin(self, source: Address, message: common.MissionCount, raw: bytes, now: float) -> None:
        """Handle a MISSION_COUNT within the limits."""
        kind = int(message.mission_type)
        running, ended = self._running.get(kind), self._ended.get((source, kind))
        if running is not None and running.source != source:
            self.acknowledge(source, kind, _Result.DENIED)
        elif ended is not None and ended.count == message.count and now - ended.at < LATE_COUNT_WINDOW:
            return  # a late duplicate; if it is a new upload, the client repeats the count
        elif not any(known is not None and known.is_duplicate(raw, now) for known in (running, ended)):
            self._ended.pop((source, kind), None)
            smallest = self._request_interval
            trip = RoundTrip(initial=max(INITIAL_TIMEOUT, smallest), minimum=smallest, maximum=3.0)
            upload = Upload(kind, source, message.count, raw, now, now, trip)
            self._running[kind] = upload
            self._continue(upload, now)

    def receive_item(
        self, source: Address, message: common.MissionItemInt | common.MissionItem, now: float
    ) -> None:
        """Handle an item."""
        kind = int(message.mission_type)
        upload = self._running.get(kind)
        if upload is None or upload.source != source:
            self._stale_item(source, message, now)
        elif upload.storing:
            return  # nothing is answered yet: the client repeats its last item until it is acknowledged
        elif message.seq == upload.due:
            upload.as_float = isinstance(message, common.MissionItem)
            upload.measure(now)
            self._due_item(upload, MissionItem.read(message), now)
        elif not upload.was_just_requested(now):
            self._request(upload, now)

    def acknowledged(self, source: Address, message: common.MissionAck, now: float) -> None:
        """Handle MISSION_ACK: the client cancels, or wants the other form of request."""
        upload = self._running.get(int(message.mission_type))
        if upload is None or upload.source != source:
            return
        if message.type == _Result.OPERATION_CANCELLED:
            self.drop(upload.type)
            self.acknowledge(source, upload.type, _Result.OPERATION_CANCELLED)
        elif (
            message.type == _Result.UNSUPPORTED and not upload.storing and not upload.was_just_requested(now)
        ):
            upload.as_float = not upload.as_float
            self._request(upload, now)

    def finish(self, plan_type: int, result: int, plan_id: int, now: float) -> bool:
        """End an upload whose plan the program has stored, or could not; False if there is none."""
        upload = self._running.get(plan_type)
        if upload is None or not upload.storing:
            return False
        self._end_complete(upload, result, plan_id, now)
        return True

    def drop(self, plan_type: int) -> None:
        """End an upload without an answer."""
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
        """Return when to call `handle_timeout`."""
        return earliest(*(upload.request_at for upload in self._running.values()))

    def handle_timeout(self, now: float) -> None:
        """Repeat requests without an answer, and end silent uploads."""
        for upload in tuple(self._running.values()):
            if upload.storing:
                continue
            if now - upload.progress_at >= IDLE_TIMEOUT:
                self.drop(upload.type)
                self.acknowledge(upload.source, upload.type, _Result.OPERATION_CANCELLED)
            elif upload.request_at is not None and now >= upload.request_at:
                if upload.due == 0 and upload.tries >= LEGACY_REQUEST_AFTER:
                    upload.as_float = not upload.as_float
                self._request(upload, now)

    def _due_item(self, upload: Upload, item: MissionItem, now: float) -> None:
        result = self._check(upload.type, upload.due, item)
        if result != _Result.ACCEPTED:
            self._end(upload, item, result, 0, now)
            return
        upload.items.append(item)
        upload.tries, upload.progress_at = 0, now
        self._continue(upload, now)

    def _continue(self, upload: Upload, now: float) -> None:
        if upload.due < upload.count:
            self._request(upload, now)
            return
        upload.storing, upload.request_at = True, None
        outcome = self._complete(Plan(upload.type, tuple(upload.items)), upload.source)
        if outcome is not None:
            self._end_complete(upload, *outcome, now)

    def _end_complete(self, upload: Upload, result: int, plan_id: int, now: float) -> None:
        last = upload.items.pop() if upload.items else None
        self._end(upload, last, result, plan_id, now)

    def _end(self, upload: Upload, item: MissionItem | None, result: int, plan_id: int, now: float) -> None:
        """Send the final answer to the due item, or to the count of an empty plan."""
        self.drop(upload.type)
        key = (upload.source, upload.type)
        self._ended[key] = _Ended(upload.count, upload.count_raw, upload.due, item, result, plan_id, now)
        if len(self._ended) > MAX_REMEMBERED:
            self._ended.popitem(last=False)
        self.acknowledge(upload.source, upload.type, result, plan_id)

    def _stale_item(
        self, source: Address, message: common.MissionItemInt | common.MissionItem, now: float
    ) -> None:
        kind = int(message.mission_type)
        ended = self._ended.get((source, kind))
        known = ended is not None and now - ended.at < ENDED_UPLOAD_LIFETIME and ended.seq == message.seq
        if ended is not None and known and ended.item == MissionItem.read(message):
            self.acknowledge(source, kind, ended.result, ended.plan_id)
        elif ended is None or now - ended.at >= ENDED_UPLOAD_LIFETIME or message.seq > ended.seq:
            self.acknowledge(source, kind, _Result.ERROR)

    def _request(self, upload: Upload, now: float) -> None:
        plain = self._plain_requests or upload.as_float
        kind = common.MissionRequest if plain else common.MissionRequestInt
        request = kind(
            target_system=upload.source.system,
            target_component=upload.source.component,
            seq=upload.due,
            mission_type=upload.type,
        )
        upload.tries += 1
        upload.requested_at = now
        once = upload.round_trip.timeout()
        again = now + min(upload.round_trip.timeout(upload.tries), max(MAX_TIMEOUT, 2 * once))
        upload.request_at = min(again, max(upload.progress_at + IDLE_TIMEOUT, now + 0.001))
        self._reply(request, upload.source)
