"""The download of a plan (guide: mission protocol, download).

    listing ── count ──► receiving ── item due ──► receiving … ── last item ──► ack sent ──► the plan
       ▲                     ├── ack ERROR, or long silence ──► listing again
       └─────────────────────┘── any other ack ──► denied

One item is requested at a time, and after a loss the due item again: PX4 ends the transfer when items are
requested out of order. A second count, after two requests of the list, means that the vehicle restarted the
transfer: then so does the download. If the counts differ, the plan was changed meanwhile and either may be
the late one: so all messages in transit are ignored and the list is requested again.
"""

from __future__ import annotations

from enum import Enum, auto
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.mission.item import MissionItem
from mavstack.services.mission.plan import PLAN_TYPES, Plan, name_of
from mavstack.services.mission.stale_messages import SETTLE
from mavstack.services.mission.transfer import MAX_ROUNDS, Transfer

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: The number of requests for one item after which the download restarts, because the vehicle seems to have
#: lost it.
TRIES_BEFORE_RESTART = 6
#: The number of MISSION_COUNT messages after which the download fails, because it would restart endlessly.
MAX_COUNTS = 64

_Result = common.MavMissionResult


class Stage(Enum):
    """The stage of a download."""

    LISTING = auto()
    RECEIVING = auto()


class DownloadPlan(Transfer[Plan]):
    """The download of one plan."""

    def __init__(self, plan_type: int, *, timeout: float | None = None) -> None:
        if plan_type not in PLAN_TYPES:
            raise InvalidArgumentError(f"plan_type must be one of PLAN_TYPES, got {plan_type}")
        super().__init__(f"downloading {name_of(plan_type)} from", plan_type, timeout)
        self.stage = Stage.LISTING
        self._items: list[MissionItem] = []
        self._count = 0
        self._plan_id = 0
        self._count_raw = b""
        self._rounds = 0
        self._counts = 0
        self._float = False

    def open(self, now: float) -> None:
        self._list(now)

    def handle_message(self, packet: Packet, now: float) -> None:
        message = packet.message
        match message:
            case common.MissionCount() if packet.raw != self._count_raw:
                self._count_raw = packet.raw
                self._counted(message, now)
            case common.MissionItemInt(seq=seq) | common.MissionItem(seq=seq):
                if self.stage is Stage.RECEIVING and seq == len(self._items):
                    self._received(MissionItem.read(message), now)
            case common.MissionAck(type=result) if result != _Result.ACCEPTED:
                self._stopped(result, now)

    def handle_silence(self, now: float) -> None:
        if self.stage is Stage.LISTING:
            self._list(now)
        elif self.tries >= TRIES_BEFORE_RESTART:
            self._restart(now)
        else:
            self._request_item(now)

    def _list(self, now: float) -> None:
        self.stage = Stage.LISTING
        target = self.target
        message = common.MissionRequestList(
            target_system=target.system, target_component=target.component, mission_type=self.type
        )
        self.request(message, now)

    def _request_item(self, now: float) -> None:
        target, seq = self.target, len(self._items)
        kind = common.MissionRequest if self._float else common.MissionRequestInt
        message = kind(
            target_system=target.system, target_component=target.component, seq=seq, mission_type=self.type
        )
        self.request(message, now)

    def _counted(self, message: common.MissionCount, now: float) -> None:
        self._counts += 1
        if self._counts > MAX_COUNTS:
            self.time_out(now, "the vehicle restarted the transfer endlessly")
            return
        if self.stage is Stage.LISTING:
            self.answered(now)
        elif (message.count, message.opaque_id) != (self._count, self._plan_id):
            self._restart(now, _Result.ERROR)
            return
        self._count, self._plan_id, self._items = message.count, message.opaque_id, []
        self.stage, self.tries = Stage.RECEIVING, 0
        self.report_progress(now)
        self._request_next(now)

    def _received(self, item: MissionItem, now: float) -> None:
        self.answered(now)
        self._items.append(item)
        self.report_progress(now, len(self._items), self._count)
        self._request_next(now)

    def _request_next(self, now: float) -> None:
        if len(self._items) < self._count:
            self._request_item(now)
            return
        self.acknowledge(_Result.ACCEPTED, now)
        self.finish(Plan(self.type, tuple(self._items), self._plan_id))

    def _stopped(self, result: int, now: float) -> None:
        receiving = self.stage is Stage.RECEIVING
        if receiving and result == _Result.UNSUPPORTED and not self._float:
            self._float, self.tries = True, 0
            self._request_item(now)
        elif receiving and result in (_Result.ERROR, _Result.INVALID_SEQUENCE):
            self._restart(now, result)
        else:
            self.refused(result, len(self._items) if receiving else None)

    def _restart(self, now: float, result: int | None = None) -> None:
        """Request the list again, after all messages in transit have arrived."""
        self._rounds += 1
        if self._rounds <= MAX_ROUNDS:
            self.tries = 0
            self._items = []
            self.pause(SETTLE, now)
        elif result is not None:
            self.refused(result, len(self._items))
        else:
            self.time_out(now)
