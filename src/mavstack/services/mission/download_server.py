"""The vehicle's side of downloads: the clients that downloaded a list, and the items that they requested.

Any number of clients can download concurrently. A client that requests items must have requested the list
since the last change of the plan, else its items would be of two plans; it gets ERROR and requests the list
again. Items may be requested in any order. They are sent when the links to the client have room.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.services.service import Outgoing, Priority

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.dialects import Message
    from mavstack.services.addressing import Address
    from mavstack.services.mission.plan import Plan
    from mavstack.services.service import HasRoom

MAX_CLIENTS = 64
MAX_WAITING = 256

_Result = common.MavMissionResult


class _Requested(NamedTuple):
    source: Address
    type: int
    seq: int


class DownloadServer:
    """The downloads from one vehicle; `shown` returns a plan, `current` its current item or -1."""

    def __init__(
        self,
        shown: Callable[[int], Plan],
        current: Callable[[int], int],
        refuse: Callable[[Address, int, int], None],
        reply: Callable[[Message, Address], None],
    ) -> None:
        self._shown, self._current, self._refuse, self._reply = shown, current, refuse, reply
        self._clients: OrderedDict[tuple[Address, int], None] = OrderedDict()
        self._requested: OrderedDict[_Requested, bool] = OrderedDict()

    def list(self, source: Address, plan_type: int) -> None:
        """Handle MISSION_REQUEST_LIST."""
        self._clients[source, plan_type] = None
        self._clients.move_to_end((source, plan_type))
        if len(self._clients) > MAX_CLIENTS:
            self._clients.popitem(last=False)
        plan = self._shown(plan_type)
        count = common.MissionCount(
            target_system=source.system,
            target_component=source.component,
            count=len(plan),
            mission_type=plan_type,
            opaque_id=plan.plan_id,
        )
        self._reply(count, source)

    def request(self, source: Address, plan_type: int, seq: int, *, as_float: bool) -> None:
        """Handle a request for an item; `as_float` answers with MISSION_ITEM."""
        if (source, plan_type) not in self._clients:
            self._refuse(source, plan_type, _Result.ERROR)
        elif seq >= len(self._shown(plan_type)):
            self._refuse(source, plan_type, _Result.INVALID_SEQUENCE)
        elif len(self._requested) < MAX_WAITING:
            self._requested[_Requested(source, plan_type, seq)] = as_float

    def changed(self, plan_type: int) -> None:
        """Handle the replacement of a plan: all its downloads end with ERROR."""
        for key in [key for key in self._clients if key[1] == plan_type]:
            del self._clients[key]
        for wanted in [wanted for wanted in self._requested if wanted.type == plan_type]:
            del self._requested[wanted]
            self._refuse(wanted.source, plan_type, _Result.ERROR)

    def messages(self, has_room: HasRoom) -> Iterator[Outgoing]:
        """Yield the requested items for which there is room."""
        for wanted in tuple(self._requested):
            if wanted in self._requested and has_room(wanted.source):
                yield Outgoing(self._item(wanted, self._requested.pop(wanted)), wanted.source, Priority.BULK)

    def _item(self, wanted: _Requested, as_float: bool) -> common.MissionItemInt | common.MissionItem:
        item = self._shown(wanted.type).items[wanted.seq]
        form = item.to_float if as_float else item.to_int
        return form(wanted.source, wanted.seq, wanted.type, current=self._current(wanted.type) == wanted.seq)
