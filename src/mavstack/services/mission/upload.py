"""Giving a vehicle a plan (guide: mission protocol, upload).

    counting ── request ──► sending ── request ──► sending … ── ack ACCEPTED ──► the plan, with its id
        │                      ├── ack ERROR, or silence after the last item ──► verifying
        │                      ├── ack ERROR twice before the last item ──► counting again
        └── ack ──► denied     └── any other ack ──► denied

The vehicle asks for the items, and whatever it asks for it gets, in order or not. If it falls silent, either
our item was lost or its next request, and which of them cannot be told: so the item that was due is sent
again, and the next one with it. A vehicle that has the first passes over it (PX4 without a word, ArduPilot
with INVALID_SEQUENCE, which therefore ends nothing) and takes the second, so either loss costs one round trip
and not the second that a vehicle takes to ask again.

ERROR may be the answer to a late copy (PX4, to a count when items have come) while the upload goes on. So the
item that is due is sent once more, and only a second ERROR counts: then the vehicle knows nothing of the
upload, because it was restarted or gave up, and the upload begins again.

A lost last acknowledgement is ambiguous. PX4 repeats it if the last item comes again; others say ERROR or
nothing. Then the plan is read back, and what the vehicle holds decides: if it is not the plan, the upload
begins again.
"""

from __future__ import annotations

from collections import deque
from enum import Enum, auto
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import LocalProtocolError, RemoteTimeout
from mavstack.services.mission.download import DownloadPlan
from mavstack.services.mission.plan import MOST_ITEMS, PLAN_TYPES, Plan, PlanType, name_of
from mavstack.services.mission.transfer import MOST_ROUNDS, IDLE_TIMEOUT, Transfer
from mavstack.services.service import Outgoing, Priority

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.operation import Operation
    from mavstack.services.service import HasRoom
    from mavstack.wire import Packet

#: After so much silence after the last item the plan is read back.
SILENT_TRIES = 6
#: How many times ERROR must answer the count to be believed.
MOST_ERRORS = 3
ERROR_PAUSE = 1.0
#: For so many round trips an item that was sent is not sent again, whoever asks for it.
ON_ITS_WAY = 1.2
#: Longer than any reading back, which has its own patience.
VERIFY_IDLE_TIMEOUT = 3600.0

_Result = common.MavMissionResult


class Stage(Enum):
    """Where an upload stands."""

    COUNTING = auto()
    SENDING = auto()
    VERIFYING = auto()


class UploadPlan(Transfer[Plan]):
    """One plan given to the vehicle; the result is the plan under the vehicle's id for it.

    `home_first`: the vehicle puts its home in the place of a mission's first item, as ArduPilot does.
    """

    writes = True

    def __init__(self, plan: Plan, *, timeout: float | None = None, home_first: bool = False) -> None:
        if plan.type not in PLAN_TYPES or len(plan) > MOST_ITEMS:
            raise LocalProtocolError(f"{len(plan)} items of type {plan.type} are not a plan that can be sent")
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

    def hear(self, packet: Packet, now: float) -> None:
        message = packet.message
        if self.stage is Stage.VERIFYING:
            return
        match message:
            case common.MissionRequest(seq=seq) | common.MissionRequestInt(seq=seq) if seq < len(self.plan):
                self._asks_float = isinstance(message, common.MissionRequest)
                self._requested(seq, now)
            case common.MissionAck(type=result, opaque_id=plan_id):
                self._acknowledged(result, plan_id, now)

    def silent(self, now: float) -> None:
        if self.stage is Stage.COUNTING:
            self._count(now)
        elif self.stage is Stage.SENDING:
            if self._due == len(self.plan) - 1 and self.tries >= SILENT_TRIES:
                self._verify(now)
            else:
                self._queue = deque(seq for seq in (self._due, self._due + 1) if seq < len(self.plan))

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        while self._queue and has_room(self.target):
            seq = self._queue.popleft()
            if seq == self._due:
                self.asked(now)
            self._sent_times[seq] = now
            item = self.plan.items[seq]
            form = item.to_float if self._float else item.to_int
            yield Outgoing(form(self.target, seq, self.type), self.target, Priority.BULK)

    def child_ended(self, child: Operation[Any], now: float) -> None:
        """The plan was read back."""
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
            self._again(now)

    def time_out(self, now: float, answer: str = "no answer") -> None:
        if self._was_last_sent():
            answer = "all items were sent, but whether it took them is not known"
        super().time_out(now, answer)

    def clean_up(self, now: float) -> None:
        self._strays.gave_up(self.type, now)
        if self.stage is not Stage.VERIFYING:
            super().clean_up(now)

    def _begin_round(self) -> None:
        self._due = -1
        self._furthest = -1
        self._errors = 0
        self._probing = False
        self._asks_float = self._float = False
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
        self.ask(message, now)

    def _requested(self, seq: int, now: float) -> None:
        if self.stage is Stage.COUNTING:
            if seq > 0 and self._rounds == 0:
                return  # it is in another upload, and has not heard our count
            self._strays.stopped(self.type)
        if self.stage is Stage.COUNTING or seq > self._due:
            self.answered(now)
        self.stage, self._due, self._probing = Stage.SENDING, seq, False
        if seq > self._furthest:
            self._furthest = seq
            self.report_progress(now, seq, len(self.plan))
        if self._is_on_its_way(seq, now):
            self.tries, self.sent_at = 1, self._sent_times[seq]
            self.timer = self.sent_at + self._round_trip.timeout()
        elif seq not in self._queue:
            self._queue.append(seq)

    def _is_on_its_way(self, seq: int, now: float) -> bool:
        """Whether the item was sent so lately that the request may have been made before it came."""
        sent_at, trip = self._sent_times.get(seq), self._round_trip.smoothed
        return sent_at is not None and trip is not None and now - sent_at < ON_ITS_WAY * trip

    def _was_last_sent(self) -> bool:
        return len(self.plan) - 1 in self._sent_times

    def _acknowledged(self, result: int, plan_id: int, now: float) -> None:
        if result == _Result.ACCEPTED:
            if self._was_last_sent() or (not self.plan.items and not plan_id):
                self.answered(now)
                self.report_progress(now, len(self.plan), len(self.plan))
                self.finish(self.plan.with_id(plan_id))
        elif result == _Result.INVALID_SEQUENCE:
            return  # it has that item, and asks for another or will
        elif self.stage is Stage.COUNTING:
            if result != _Result.OPERATION_CANCELLED:
                self._count_refused(result, now)
        elif result == _Result.UNSUPPORTED and self._asks_float and not self._float:
            self._float = True
            self._queue = deque([self._due])
        elif result == _Result.ERROR:
            self._troubled(now)
        elif result == _Result.DENIED and not self._probing and not self._was_last_sent():
            self._probe()  # ArduPilot says so to a late request of a download, and goes on
        else:
            self.refused(result, self._due)

    def _count_refused(self, result: int, now: float) -> None:
        self._errors += 1
        if result == _Result.ERROR and self._errors < MOST_ERRORS:
            # PX4 is still in another transfer of ours. What it does until it has left it is not for this one.
            self.acknowledge(_Result.OPERATION_CANCELLED, now)
            self.pause(ERROR_PAUSE, now)
        else:
            self.refused(result)

    def _troubled(self, now: float) -> None:
        """ERROR: perhaps about a late copy, perhaps because the vehicle knows nothing of the upload."""
        if self._was_last_sent():
            self._verify(now)
        elif not self._probing:
            self._probe()
        else:
            self._again(now)

    def _probe(self) -> None:
        """Send the due item again: if that is answered in the same way, it was no late answer."""
        self._probing = True
        self._queue = deque([self._due])

    def _verify(self, now: float) -> None:
        self.stage, self.timer = Stage.VERIFYING, None
        self._idle_timeout = VERIFY_IDLE_TIMEOUT
        self.report_progress(now)
        self.begin(DownloadPlan(self.type), now)

    def _again(self, now: float) -> None:
        self._rounds += 1
        item = self._due
        if self._rounds > MOST_ROUNDS:
            self.refused(_Result.ERROR, item)
            return
        self.tries = 0
        self._begin_round()
        self.report_progress(now)
        self._count(now)
