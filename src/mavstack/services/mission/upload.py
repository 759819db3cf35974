"""The upload of a plan (guide: mission protocol, upload).

    counting ── request ──► sending ── request ──► sending … ── ack ACCEPTED ──► the plan, with its id
        │                      ├── ack ERROR, or silence after the last item ──► verifying
        │                      ├── ack ERROR twice before the last item ──► counting again
        └── ack ──► denied     └── any other ack ──► denied

The vehicle requests the items, and gets each item that it requests, in any order. When it falls silent,
either the last item or its next request was lost, and the two cannot be told apart: so the due item is sent
again together with the next one. A vehicle that has the first ignores it (PX4 silently, ArduPilot with
INVALID_SEQUENCE, which therefore ends nothing) and accepts the second, so either loss costs one round trip
and not the second after which a vehicle repeats its request.

UNSUPPORTED may refer to the form of the item, and DENIED to a late request of a download: the item is sent
once more. If another refusal follows, such as ERROR from a vehicle that has ended the upload, the first one
referred to that item.

ERROR may be the answer to a late duplicate (from PX4, to a count after items) while the upload continues. So
the due item is sent once more, and only a second ERROR counts: then the vehicle has lost the upload, because
it rebooted or gave up, and the upload restarts.

A lost last acknowledgement is ambiguous. PX4 repeats it when the last item comes again; others send ERROR or
nothing. Then the plan is downloaded, and compared: if it differs, the upload restarts.
"""

from __future__ import annotations

from collections import deque
from enum import Enum, auto
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, RemoteTimeout
from mavstack.services.mission.download import DownloadPlan
from mavstack.services.mission.plan import MAX_ITEMS, PLAN_TYPES, Plan, PlanType, name_of
from mavstack.services.mission.transfer import IDLE_TIMEOUT, MAX_ROUNDS, Transfer
from mavstack.services.service import Outgoing, Priority

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.operation import Operation
    from mavstack.services.service import HasRoom
    from mavstack.wire import Packet

#: The number of unanswered repetitions of the last item after which the plan is downloaded to verify it.
TRIES_BEFORE_VERIFY = 6
#: The number of MAV_MISSION_ERROR answers to MISSION_COUNT that end the upload.
MAX_ERRORS = 3
ERROR_PAUSE = 1.0
#: The number of round trips after an item was sent in which a repeated request for it is ignored.
MIN_RESEND_ROUND_TRIPS = 1.2
#: Idle timeout of a verification, in seconds: long, because its download has a shorter idle timeout.
VERIFY_IDLE_TIMEOUT = 3600.0

_Result = common.MavMissionResult


class Stage(Enum):
    """The stage of an upload."""

    COUNTING = auto()
    SENDING = auto()
    VERIFYING = auto()


class UploadPlan(Transfer[Plan]):
    """The upload of one plan; the result is the plan with the vehicle's id.

    Args:
        plan: The plan.
        timeout: Seconds for the whole operation; None sets no overall limit.
        home_first: True if the vehicle replaces the first item of a mission by its home, as ArduPilot does.
    """

    writes = True

    def __init__(self, plan: Plan, *, timeout: float | None = None, home_first: bool = False) -> None:
        if plan.type not in PLAN_TYPES or len(plan) > MAX_ITEMS:
            raise InvalidArgumentError(
                f"a plan must have a type in PLAN_TYPES and at most {MAX_ITEMS} items, "
                f"got type {plan.type} and {len(plan)} items"
            )
        super().__init__(f"uploading {name_of(plan.type)} to", plan.type, timeout)
        self.plan = plan
        self.stage = Stage.COUNTING
        self._skip = 1 if home_first and plan.type == PlanType.MISSION else 0
        self._rounds = 0
        self._queue: deque[int] = deque()
        self._sent_times: dict[int, float] = {}
        self._begin_round()

    def open(self, now: float) -> None:
        self._count(now)

    def handle_message(self, packet: Packet, now: float) -> None:
        message = packet.message
        if self.stage is Stage.VERIFYING:
            return
        match message:
            case common.MissionRequest(seq=seq) | common.MissionRequestInt(seq=seq) if seq < len(self.plan):
                self._requests_float = isinstance(message, common.MissionRequest)
                self._item_requested(seq, now)
            case common.MissionAck(type=result, opaque_id=plan_id):
                self._acknowledged(result, plan_id, now)

    def handle_silence(self, now: float) -> None:
        if self.stage is Stage.COUNTING:
            self._count(now)
        elif self.stage is Stage.SENDING:
            if self._due == len(self.plan) - 1 and self.tries >= TRIES_BEFORE_VERIFY:
                self._verify(now)
            else:
                self._queue = deque(seq for seq in (self._due, self._due + 1) if seq < len(self.plan))

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        while self._queue and has_room(self.target):
            seq = self._queue.popleft()
            if seq == self._due:
                self.requested(now)
            self._sent_times[seq] = now
            item = self.plan.items[seq]
            form = item.to_float if self._float else item.to_int
            yield Outgoing(form(self.target, seq, self.type), self.target, Priority.BULK)

    def child_ended(self, child: Operation[Any], now: float) -> None:
        """Compare the downloaded plan."""
        if self.done:
            return
        self._idle_timeout = IDLE_TIMEOUT
        self.report_progress(now)
        if child.error is None:
            held: Plan = child.result()
            if len(held) == len(self.plan) and held.items[self._skip :] == self.plan.items[self._skip :]:
                self.finish(self.plan.with_id(held.plan_id))
                return
        if isinstance(child.error, RemoteTimeout):
            self.time_out(now)
        else:
            self._restart(now)

    def time_out(self, now: float, answer: str = "no answer") -> None:
        if self._doubted is not None:
            self._item_refused(self._doubted)
            return
        if self._was_last_sent():
            answer = "all items were sent, but the vehicle did not confirm them"
        super().time_out(now, answer)

    def clean_up(self, now: float) -> None:
        self._stale_messages.upload_abandoned(self.type, now)
        if self.stage is not Stage.VERIFYING:
            super().clean_up(now)

    def _begin_round(self) -> None:
        self._due = -1
        self._furthest = -1
        self._errors = 0
        self._probing = False
        self._doubted: int | None = None
        self._requests_float = self._float = False
        self._queue.clear()
        self._sent_times.clear()

    def _count(self, now: float) -> None:
        self.stage = Stage.COUNTING
        target = self.target
        message = common.MissionCount(
            target_system=target.system,
            target_component=target.component,
            count=len(self.plan),
            mission_type=self.type,
        )
        self.request(message, now)

    def _item_requested(self, seq: int, now: float) -> None:
        if self.stage is Stage.COUNTING:
            if seq > 0 and self._rounds == 0:
                return  # the vehicle is still in another upload, and has not received the count
            self._stale_messages.upload_stopped(self.type)
        if self.stage is Stage.COUNTING or seq > self._due:
            self.answered(now)
        self.stage, self._due, self._probing = Stage.SENDING, seq, False
        if seq > self._furthest:
            self._furthest, self._doubted = seq, None
            self.report_progress(now, seq, len(self.plan))
        if self._is_in_transit(seq, now):
            self.tries, self.sent_at = 1, self._sent_times[seq]
            self.timer = self.sent_at + self._round_trip.timeout()
        elif seq not in self._queue:
            self._queue.append(seq)

    def _is_in_transit(self, seq: int, now: float) -> bool:
        """Return whether the item was sent so recently that the request may be older than its arrival."""
        sent_at, trip = self._sent_times.get(seq), self._round_trip.smoothed
        return sent_at is not None and trip is not None and now - sent_at < MIN_RESEND_ROUND_TRIPS * trip

    def _was_last_sent(self) -> bool:
        return len(self.plan) - 1 in self._sent_times

    def _acknowledged(self, result: int, plan_id: int, now: float) -> None:
        if result == _Result.ACCEPTED:
            if self._was_last_sent() or (not self.plan.items and not plan_id):
                self.answered(now)
                self.report_progress(now, len(self.plan), len(self.plan))
                self.finish(self.plan.with_id(plan_id))
        elif result == _Result.INVALID_SEQUENCE:
            return  # the vehicle has this item already, and will request another one
        elif self.stage is Stage.COUNTING:
            if result != _Result.OPERATION_CANCELLED:
                self._count_refused(result, now)
        elif self._doubted is not None:
            self._item_refused(self._doubted)
        elif result == _Result.UNSUPPORTED and self._requests_float and not self._float:
            self._float = True
            self._doubted = result
            self._queue = deque([self._due])
        elif result == _Result.ERROR:
            self._error_received(now)
        elif result == _Result.DENIED and not self._probing and not self._was_last_sent():
            self._doubted = result
            # ArduPilot sends DENIED for a late request of a download, and continues with the upload
            self._probe()
        else:
            self._item_refused(result)

    def _item_refused(self, result: int) -> None:
        """Fail, since the vehicle refuses the due item."""
        self.refused(result, self._due, self.plan.items[self._due].description)

    def _count_refused(self, result: int, now: float) -> None:
        self._errors += 1
        if result == _Result.ERROR and self._errors < MAX_ERRORS:
            # PX4 is still in an earlier transfer: its messages are ignored until it has left that transfer.
            self.acknowledge(_Result.OPERATION_CANCELLED, now)
            self.pause(ERROR_PAUSE, now)
        else:
            self.refused(result)

    def _error_received(self, now: float) -> None:
        """Handle ERROR: the answer to a late duplicate, or the vehicle has lost the upload."""
        if self._was_last_sent():
            self._verify(now)
        elif not self._probing:
            self._probe()
        else:
            self._restart(now)

    def _probe(self) -> None:
        """Send the due item again: the same answer then is no late one."""
        self._probing = True
        self._queue = deque([self._due])

    def _verify(self, now: float) -> None:
        self.stage, self.timer = Stage.VERIFYING, None
        self._idle_timeout = VERIFY_IDLE_TIMEOUT
        self.report_progress(now)
        self.begin(DownloadPlan(self.type), now)

    def _restart(self, now: float) -> None:
        self._rounds += 1
        item = self._due
        if self._rounds > MAX_ROUNDS:
            self._due = item
            self._item_refused(_Result.ERROR)
            return
        self.tries = 0
        self._begin_round()
        self.report_progress(now)
        self._count(now)
