"""The vehicle's side: holds the plans, takes new ones whole or not at all, and says where the mission is.

A program judges each item (`check`) and each whole plan (`validate`, also the empty one that clearing
leaves); only what both accept replaces the old plan. Who asks with MISSION_REQUEST gets MISSION_ITEM_INT, as
the guide wants it, unless it speaks MAVLink 1, where only old programs are left that know nothing but
MISSION_ITEM. Partial lists are not part of the protocol and are refused.

The firmwares keep to what the guide said once, and scripts for them count on it: with `float_answers`
MISSION_REQUEST is answered with MISSION_ITEM to everybody, with `plain_requests` (ArduPilot) it is also what
uploads are asked for by, and either form of item is taken. Some count how often they are asked: `ask_again`
is how long an answer may take at least, in seconds.

`home_first` makes a mission as ArduPilot has it: its item 0 is the vehicle's `home`, whatever was uploaded
there.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.errors import LocalProtocolError
from mavstack.services.addressing import EVERYBODY, Address, message_ids
from mavstack.services.mission.item import MissionItem
from mavstack.services.mission.plan import MOST_ITEMS, PLAN_TYPES, Plan, PlanStore, PlanType
from mavstack.services.mission.receiving import ASK_AGAIN, MOST_REMEMBERED, Uploads
from mavstack.services.mission.sending import Downloads
from mavstack.services.service import Event, HasRoom, Outgoing, Service, always_room
from mavstack.services.timing import DOUBLED_WITHIN

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.dialects import Message
    from mavstack.services.command import CommandRequest, CommandServer
    from mavstack.wire import Packet

DEFAULT_LIMITS: Mapping[int, int] = dict.fromkeys((int(kind) for kind in PLAN_TYPES), 2000)
#: `total` of MISSION_CURRENT where there is no mission.
NO_MISSION = 0xFFFF

_Result = common.MavMissionResult

#: Judges a whole plan from someone: a MAV_MISSION_RESULT.
Validate: TypeAlias = Callable[[Plan, Address], int]
#: Goes where an item says that is no part of a plan, with its `current`: a MAV_MISSION_RESULT.
Guided: TypeAlias = "Callable[[MissionItem, int], int]"
#: Values of `current` by which ground stations of old say "go there" and "to that altitude", to ArduPilot.
GUIDED = frozenset({2, 3})
#: Judges an item of a plan type, at its place: a MAV_MISSION_RESULT.
Check: TypeAlias = "Callable[[int, int, MissionItem], int]"


@dataclass(frozen=True, slots=True)
class PlanReplaced(Event):
    """Someone uploaded a plan, or cleared one: then it is empty."""

    plan: Plan
    source: Address


@dataclass(frozen=True, slots=True)
class CurrentItemSet(Event):
    """Someone wants the mission to go on at an item; `reset`: from its beginning state, jump counters too."""

    seq: int
    source: Address
    reset: bool = False


class MissionServer(Service):
    """The plans of one vehicle; `limits` says how many items of which types it can hold."""

    handles = message_ids(
        common.MissionRequestList,
        common.MissionRequest,
        common.MissionRequestInt,
        common.MissionCount,
        common.MissionItem,
        common.MissionItemInt,
        common.MissionAck,
        common.MissionClearAll,
        common.MissionSetCurrent,
        common.MissionWritePartialList,
        common.MissionRequestPartialList,
    )

    def __init__(
        self,
        local: Address,
        store: PlanStore | None = None,
        *,
        limits: Mapping[int, int] = DEFAULT_LIMITS,
        validate: Validate = lambda plan, source: _Result.ACCEPTED,
        check: Check = lambda plan_type, seq, item: _Result.ACCEPTED,
        plan_ids: bool = True,
        home_first: bool = False,
        guided: Guided | None = None,
        plain_requests: bool = False,
        float_answers: bool = False,
        ask_again: float = ASK_AGAIN,
    ) -> None:
        super().__init__(local)
        self.store = store or PlanStore()
        self.limits = {int(kind): min(limit, MOST_ITEMS) for kind, limit in limits.items()}
        self.home: MissionItem | None = None
        self.state: int = common.MissionState.NOT_STARTED
        #: Whether the vehicle flies the mission (1), or does something else (2); 0: nobody says.
        self.mode = 0
        self._validate, self._check, self._guided = validate, check, guided
        self._plan_ids, self._home_first = plan_ids, home_first
        self._current = 0
        #: What `plan` gave last, and of what it was made: it is asked for with every item.
        self._shown: dict[int, tuple[Plan, MissionItem | None, Plan]] = {}
        self._cleared: OrderedDict[Address, tuple[bytes, float]] = OrderedDict()
        self._float_answers = float_answers
        self._uploads = Uploads(
            self._complete, check, self._reply, plain_requests=plain_requests, ask_again=ask_again
        )
        self._downloads = Downloads(self.plan, self._current_of, self._uploads.acknowledge, self._reply)

    # For the program

    def plan(self, plan_type: int) -> Plan:
        """The plan of a type as it is shown to others, under its id."""
        held = self.store.get(plan_type)
        made_of = self._shown.get(plan_type)
        if made_of is None or made_of[0] is not held or made_of[1] is not self.home:
            made_of = self._shown[plan_type] = (held, self.home, self._as_shown(held))
        return made_of[2]

    def replace(self, plan: Plan) -> None:
        """Put a plan of the program's own in the place of the one of its type."""
        if len(plan) > self.limits.get(plan.type, 0):
            raise LocalProtocolError(f"{len(plan)} items of type {plan.type} are over this vehicle's limits")
        self._put(plan)

    def take(self, plan: Plan, source: Address) -> int:
        """Judge a plan that came whole by another way, such as a file, and put it if it is accepted."""
        if len(plan) > self.limits.get(plan.type, -1):
            return _Result.NO_SPACE if plan.type in self.limits else _Result.UNSUPPORTED
        for seq, item in enumerate(plan.items):
            result = self._check(plan.type, seq, item)
            if result != _Result.ACCEPTED:
                return result
        return self._complete(plan, source)[0]

    @property
    def current(self) -> int:
        """The mission's current item."""
        return self._current

    def set_current(self, seq: int) -> None:
        """The vehicle goes on to an item: tell everybody."""
        if not 0 <= seq < max(len(self.store.get(PlanType.MISSION)), 1):
            raise LocalProtocolError(f"the mission has no item {seq}")
        self._current = seq
        self.send(self.current_message())

    def reached(self, seq: int) -> None:
        """The vehicle reached an item: tell everybody."""
        self.send(common.MissionItemReached(seq=seq))

    def current_message(self) -> common.MissionCurrent:
        """MISSION_CURRENT, which is sent on changes by itself and should be sent now and then."""
        count = len(self.store.get(PlanType.MISSION))
        ids = [self.plan(kind).plan_id for kind in PLAN_TYPES]
        return common.MissionCurrent(
            seq=self._current,
            total=max(count - self._home_first, 0) if count else NO_MISSION,
            mission_state=self.state if count else common.MissionState.NO_MISSION,
            mission_mode=self.mode,
            mission_id=ids[0],
            fence_id=ids[1],
            rally_points_id=ids[2],
        )

    def answer_commands(self, commands: CommandServer, touch: Callable[[MissionServer], None]) -> None:
        """Carry out MAV_CMD_DO_SET_MISSION_CURRENT too; `touch` is that of the engine both live in."""

        def set_current(request: CommandRequest) -> common.MavResult:
            touch(self)
            return self._set_current_command(request)

        commands.support(common.MavCmd.DO_SET_MISSION_CURRENT, set_current)

    # As a service

    def receive(self, packet: Packet, now: float) -> None:
        source = Address(packet.system, packet.component)
        match packet.message:
            case common.MissionRequestList(mission_type=kind) if self._supports(kind, source):
                self._downloads.list(source, int(kind))
            case common.MissionRequestInt(mission_type=kind, seq=seq) if self._supports(kind, source):
                self._downloads.request(source, int(kind), seq, as_float=False)
            case common.MissionRequest(mission_type=kind, seq=seq) if self._supports(kind, source):
                self._downloads.request(
                    source, int(kind), seq, as_float=self._float_answers or packet.version == 1
                )
            case common.MissionCount(mission_type=kind) as message if self._supports(kind, source):
                self._count(source, message, packet.raw, now)
            case (common.MissionItemInt() | common.MissionItem()) as message:
                self._item(source, message, now)
            case common.MissionAck() as message:
                self._uploads.acknowledged(source, message, now)
            case common.MissionClearAll(mission_type=kind):
                self._clear(source, int(kind), packet.raw, now)
            case common.MissionSetCurrent(seq=seq):
                self._set_current_message(source, seq)
            case common.MissionWritePartialList() | common.MissionRequestPartialList() as message:
                self._uploads.acknowledge(source, int(message.mission_type), _Result.UNSUPPORTED)

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        return self._downloads.messages(has_room)

    def next_timeout(self) -> float | None:
        return self._uploads.next_timeout()

    def handle_timeout(self, now: float) -> None:
        self._uploads.handle_timeout(now)

    def _as_shown(self, held: Plan) -> Plan:
        plan = held
        if self._home_first and held.type == PlanType.MISSION and self.home is not None and held.items:
            plan = Plan(held.type, (self.home, *held.items[1:]))
        return plan.with_id(held.checksum() if self._plan_ids else 0)

    def _supports(self, kind: int, source: Address) -> bool:
        if kind not in self.limits:
            self._uploads.acknowledge(source, int(kind), _Result.UNSUPPORTED)
        return kind in self.limits

    def _item(self, source: Address, message: common.MissionItemInt | common.MissionItem, now: float) -> None:
        if self._guided is not None and message.current in GUIDED:
            result = self._guided(MissionItem.read(message), int(message.current))
            self._uploads.acknowledge(source, int(message.mission_type), result)
        else:
            self._uploads.take(source, message, now)

    def _count(self, source: Address, message: common.MissionCount, raw: bytes, now: float) -> None:
        if message.count > self.limits[int(message.mission_type)]:
            self._uploads.acknowledge(source, int(message.mission_type), _Result.NO_SPACE)
        else:
            self._uploads.begin(source, message, raw, now)

    def _complete(self, plan: Plan, source: Address) -> tuple[int, int]:
        result = self._validate(plan, source)
        if result == _Result.ACCEPTED:
            self._put(plan)
            self.emit(PlanReplaced(plan, source))
        return result, self.plan(plan.type).plan_id if result == _Result.ACCEPTED else 0

    def _put(self, plan: Plan) -> None:
        self.store.put(plan)
        self._downloads.changed(plan.type)
        if plan.type == PlanType.MISSION:
            self._current = next((seq for seq, item in enumerate(plan.items) if item.current), 0)
        self.send(self.current_message())

    def _clear(self, source: Address, kind: int, raw: bytes, now: float) -> None:
        known, at = self._cleared.get(source, (b"", 0.0))
        if known == raw and now - at < DOUBLED_WITHIN:
            return
        kinds = tuple(self.limits) if kind == PlanType.ALL else (kind,)
        result = self._may_clear(source, kinds)
        if result == _Result.ACCEPTED:
            self._cleared[source] = (raw, now)
            self._cleared.move_to_end(source)
            if len(self._cleared) > MOST_REMEMBERED:
                self._cleared.popitem(last=False)
            for each in kinds:
                self._uploads.drop(each)
                self._put(Plan(each))
                self.emit(PlanReplaced(Plan(each), source))
        self._uploads.acknowledge(source, kind, result)

    def _may_clear(self, source: Address, kinds: tuple[int, ...]) -> int:
        for kind in kinds:
            upload = self._uploads.under_way(kind)
            if kind not in self.limits:
                return _Result.UNSUPPORTED
            if upload is not None and upload.source != source:
                return _Result.DENIED
            result = self._validate(Plan(kind), source)
            if result != _Result.ACCEPTED:
                return result
        return _Result.ACCEPTED

    def _set_current_message(self, source: Address, seq: int) -> None:
        if self._go_to(seq, source, reset=False):
            return
        text = f"Mission has no item {seq}"
        self.send(common.Statustext(severity=common.MavSeverity.WARNING, text=text))

    def _set_current_command(self, request: CommandRequest) -> common.MavResult:
        wanted, reset = request.command.param1, request.command.param2 == 1
        if not isfinite(wanted):
            return common.MavResult.DENIED
        seq = self._current if wanted == -1 else int(wanted)
        done = self._go_to(seq, request.source, reset=reset)
        return common.MavResult.ACCEPTED if done else common.MavResult.DENIED

    def _go_to(self, seq: int, source: Address, *, reset: bool) -> bool:
        if not 0 <= seq < len(self.store.get(PlanType.MISSION)):
            return False
        self.set_current(seq)
        self.emit(CurrentItemSet(seq, source, reset))
        return True

    def _current_of(self, plan_type: int) -> int:
        return self._current if plan_type == PlanType.MISSION else -1

    def _reply(self, message: Message, target: Address = EVERYBODY) -> None:
        self.send(message, target)
