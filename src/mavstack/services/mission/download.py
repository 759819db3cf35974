"""Asking a vehicle for a plan (guide: mission protocol, download).

    listing ── count ──► receiving ── item due ──► receiving … ── last item ──► ack sent ──► the plan
       ▲                     ├── ack ERROR, or long silence ──► listing again
       └─────────────────────┘── any other ack ──► denied

One item is asked for at a time, and after a loss again the one that is due: PX4 ends the transfer when it is
asked out of turn. A second count, after the list was asked for
twice, means that the vehicle began anew: then so do we. If the two differ, the plan was changed meanwhile and
either may be the late one: so everything is let pass by and the list is asked for again.
"""

from __future__ import annotations

from enum import Enum, auto
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import LocalProtocolError
from mavstack.services.mission.item import MissionItem
from mavstack.services.mission.plan import PLAN_TYPES, Plan, name_of
from mavstack.services.mission.strays import SETTLE
from mavstack.services.mission.transfer import MOST_ROUNDS, Transfer

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: After so many requests for one item the vehicle seems to have forgotten the transfer.
SILENT_TRIES = 6
#: So often a vehicle may count anew; who does it for ever is not waited for.
MOST_COUNTS = 64

_Result = common.MavMissionResult


class Stage(Enum):
    """Where a download stands."""

    LISTING = auto()
    RECEIVING = auto()


class DownloadPlan(Transfer[Plan]):
    """One plan as the vehicle holds it."""

    def __init__(self, plan_type: int, *, timeout: float | None = None) -> None:
        if plan_type not in PLAN_TYPES:
            raise LocalProtocolError(f"there is no plan of type {plan_type} to download")
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

    def hear(self, packet: Packet, now: float) -> None:
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

    def silent(self, now: float) -> None:
        if self.stage is Stage.LISTING:
            self._list(now)
        elif self.tries >= SILENT_TRIES:
            self._again(now)
        else:
            self._request(now)

    def _list(self, now: float) -> None:
        self.stage = Stage.LISTING
        target = self.target
        message = common.MissionRequestList(
            target_system=target.system, target_component=target.component, mission_type=self.type
        )
        self.ask(message, now)

    def _request(self, now: float) -> None:
        target, seq = self.target, len(self._items)
        kind = common.MissionRequest if self._float else common.MissionRequestInt
        message = kind(
            target_system=target.system,
            target_component=target.component,
            seq=seq,
            mission_type=self.type,
        )
        self.ask(message, now)

    def _counted(self, message: common.MissionCount, now: float) -> None:
        self._counts += 1
        if self._counts > MOST_COUNTS:
            self.time_out(now, "it began anew again and again")
            return
        if self.stage is Stage.LISTING:
            self.answered(now)
        elif (message.count, message.opaque_id) != (self._count, self._plan_id):
            self._again(now, _Result.ERROR)
            return
        self._count, self._plan_id, self._items = message.count, message.opaque_id, []
        self.stage, self.tries = Stage.RECEIVING, 0
        self.report_progress(now)
        self._next(now)

    def _received(self, item: MissionItem, now: float) -> None:
        self.answered(now)
        self._items.append(item)
        self.report_progress(now, len(self._items), self._count)
        self._next(now)

    def _next(self, now: float) -> None:
        if len(self._items) < self._count:
            self._request(now)
            return
        self.acknowledge(_Result.ACCEPTED, now)
        self.finish(Plan(self.type, tuple(self._items), self._plan_id))

    def _stopped(self, result: int, now: float) -> None:
        receiving = self.stage is Stage.RECEIVING
        if receiving and result == _Result.UNSUPPORTED and not self._float:
            self._float, self.tries = True, 0
            self._request(now)
        elif receiving and result in (_Result.ERROR, _Result.INVALID_SEQUENCE):
            self._again(now, result)
        else:
            self.refused(result, len(self._items) if receiving else None)

    def _again(self, now: float, result: int | None = None) -> None:
        """List again, when everything that is on its way has passed by."""
        self._rounds += 1
        if self._rounds <= MOST_ROUNDS:
            self.tries = 0
            self._items = []
            self.pause(SETTLE, now)
        elif result is not None:
            self.refused(result, len(self._items))
        else:
            self.time_out(now)
