"""The vehicle's side of downloads: who asked for which plan, and which items they wait for.

Any number can download at once. Who asks for items must have asked for the list since the plan was last
changed: else its items would be of two plans; it hears ERROR and asks for the list again. Items may be asked
for in any order. They are sent when the links to the one who asks have room.
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

MOST_READERS = 64
MOST_WAITING = 256

_Result = common.MavMissionResult


class _Wanted(NamedTuple):
    source: Address
    type: int
    seq: int


class Downloads:
    """All downloads from one vehicle; `shown` gives the plan of a type, `current` its current item or -1."""

    def __init__(
        self,
        shown: Callable[[int], Plan],
        current: Callable[[int], int],
        refuse: Callable[[Address, int, int], None],
        reply: Callable[[Message, Address], None],
    ) -> None:
        self._shown, self._current, self._refuse, self._reply = shown, current, refuse, reply
        self._readers: OrderedDict[tuple[Address, int], None] = OrderedDict()
        self._wanted: OrderedDict[_Wanted, bool] = OrderedDict()

    def list(self, source: Address, plan_type: int) -> None:
        """MISSION_REQUEST_LIST."""
        self._readers[source, plan_type] = None
        self._readers.move_to_end((source, plan_type))
        if len(self._readers) > MOST_READERS:
            self._readers.popitem(last=False)
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
        """MISSION_REQUEST_INT, or MISSION_REQUEST of one who wants MISSION_ITEM."""
        if (source, plan_type) not in self._readers:
            self._refuse(source, plan_type, _Result.ERROR)
        elif seq >= len(self._shown(plan_type)):
            self._refuse(source, plan_type, _Result.INVALID_SEQUENCE)
        elif len(self._wanted) < MOST_WAITING:
            self._wanted[_Wanted(source, plan_type, seq)] = as_float

    def changed(self, plan_type: int) -> None:
        """A plan was replaced: nobody gets the rest of the old one, nor that of the new one alone."""
        for key in [key for key in self._readers if key[1] == plan_type]:
            del self._readers[key]
        for wanted in [wanted for wanted in self._wanted if wanted.type == plan_type]:
            del self._wanted[wanted]
            self._refuse(wanted.source, plan_type, _Result.ERROR)

    def messages(self, has_room: HasRoom) -> Iterator[Outgoing]:
        """The items that were asked for and for which there is room."""
        for wanted in tuple(self._wanted):
            if wanted in self._wanted and has_room(wanted.source):
                yield Outgoing(self._item(wanted, self._wanted.pop(wanted)), wanted.source, Priority.BULK)

    def _item(self, wanted: _Wanted, as_float: bool) -> common.MissionItemInt | common.MissionItem:
        item = self._shown(wanted.type).items[wanted.seq]
        form = item.to_float if as_float else item.to_int
        return form(wanted.source, wanted.seq, wanted.type, current=self._current(wanted.type) == wanted.seq)
