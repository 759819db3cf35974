"""The vehicle's side of downloads: the clients that downloaded a list, and the items that they requested.

Any number of clients can download concurrently. A client that requests items must have requested the list
since the last change of the plan, else its items would be of two plans; it gets ERROR and requests the list
again. Items may be requested in any order. They are sent when the links to the client have room.

Item 0 of ArduPilot's mission is home: it can be read at any time, also while the mission is empty, and a
request beyond the mission is answered with the number of items (MISSION_COUNT) and ERROR. Scripts depend on
both: DroneKit requests item 0 of an empty mission, to learn home.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.services.mission.plan import PlanType
from mavstack.services.service import Outgoing, Priority

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.dialects import Message
    from mavstack.services.addressing import Address
    from mavstack.services.mission.item import MissionItem
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
    """The downloads from one vehicle.

    Args:
        shown: Returns a plan of a type.
        current: Returns the current item of a plan, or -1.
        refuse: Sends MISSION_ACK with a result.
        reply: Sends a message to a client.
        home: Returns home, which is item 0 of the mission (ArduPilot); None if item 0 is as uploaded.
    """

    def __init__(
        self,
        shown: Callable[[int], Plan],
        current: Callable[[int], int],
        refuse: Callable[[Address, int, int], None],
        reply: Callable[[Message, Address], None],
        *,
        home: Callable[[], MissionItem] | None = None,
    ) -> None:
        self._shown, self._current, self._refuse, self._reply = shown, current, refuse, reply
        self._home = home
        self._clients: OrderedDict[tuple[Address, int], None] = OrderedDict()
        self._requested: OrderedDict[_Requested, bool] = OrderedDict()

    def list(self, source: Address, plan_type: int) -> None:
        """Handle MISSION_REQUEST_LIST."""
        self._clients[source, plan_type] = None
        self._clients.move_to_end((source, plan_type))
        if len(self._clients) > MAX_CLIENTS:
            self._clients.popitem(last=False)
        self._send_count(source, plan_type)

    def request(self, source: Address, plan_type: int, seq: int, *, as_float: bool) -> None:
        """Handle a request for an item; `as_float` answers with MISSION_ITEM."""
        home_first = self._home is not None and plan_type == PlanType.MISSION
        is_home = home_first and seq == 0
        if (source, plan_type) not in self._clients and not is_home:
            self._refuse(source, plan_type, _Result.ERROR)
        elif seq >= len(self._shown(plan_type)) and not is_home:
            if home_first:
                self._send_count(source, plan_type)
            self._refuse(source, plan_type, _Result.ERROR if home_first else _Result.INVALID_SEQUENCE)
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

    def _send_count(self, source: Address, plan_type: int) -> None:
        plan = self._shown(plan_type)
        count = common.MissionCount(
            target_system=source.system,
            target_component=source.component,
            count=len(plan),
            mission_type=plan_type,
            opaque_id=plan.plan_id,
        )
        self._reply(count, source)

    def _item(self, wanted: _Requested, as_float: bool) -> common.MissionItemInt | common.MissionItem:
        if self._home is not None and wanted.type == PlanType.MISSION and wanted.seq == 0:
            item = self._home()
        else:
            item = self._shown(wanted.type).items[wanted.seq]
        form = item.to_float if as_float else item.to_int
        return form(wanted.source, wanted.seq, wanted.type, current=self._current(wanted.type) == wanted.seq)
