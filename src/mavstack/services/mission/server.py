"""The mission server: a vehicle's plans, their uploads and downloads, and the current item.

The program validates each item (`check`) and each complete plan (`validate`, also the empty one that clearing
leaves); a plan that passes both replaces the old one atomically. MISSION_REQUEST is answered with
MISSION_ITEM_INT, as the guide requires, unless it came in MAVLink 1, which only old programs use that know
nothing but MISSION_ITEM. Partial lists are not part of the protocol and are refused.

Firmwares follow older versions of the guide, and scripts for them depend on it: see `MissionServerOptions`.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import BROADCAST, Address, message_ids
from mavstack.services.frames import commands_with_location
from mavstack.services.mission.download_server import DownloadServer
from mavstack.services.mission.item import MissionItem
from mavstack.services.mission.plan import MAX_ITEMS, PLAN_TYPES, Plan, PlanStore, PlanType
from mavstack.services.mission.upload_server import MAX_REMEMBERED, MIN_TIMEOUT, UploadServer
from mavstack.services.service import Event, HasRoom, Outgoing, Service, always_room
from mavstack.services.timing import DUPLICATE_WINDOW

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.dialects import Message
    from mavstack.services.command import CommandRequest, CommandServer
    from mavstack.wire import Packet

DEFAULT_LIMITS: Mapping[int, int] = dict.fromkeys((int(kind) for kind in PLAN_TYPES), 2000)
#: `total` of MISSION_CURRENT if there is no mission.
NO_MISSION = 0xFFFF

_Result = common.MavMissionResult

#: Validates a complete plan from a client: returns a MAV_MISSION_RESULT.
Validate: TypeAlias = Callable[[Plan, Address], int]
#: Stores a plan on another device, which takes a while; the program then calls `finish_storing`.
StoreElsewhere: TypeAlias = Callable[[Plan, Address], None]
#: Executes an item that does not belong to a plan, given the item and its field `current`: returns a
#: MAV_MISSION_RESULT.
Guided: TypeAlias = "Callable[[MissionItem, int], int]"
#: Values of `current` with which old ground stations command ArduPilot to a position, or to an altitude.
GUIDED = frozenset({2, 3})
#: Validates an item, given its plan type and number: returns a MAV_MISSION_RESULT.
Check: TypeAlias = "Callable[[int, int, MissionItem], int]"


@dataclass(frozen=True, slots=True)
class PlanReplaced(Event):
    """A client uploaded a plan, or cleared one: then it is empty."""

    plan: Plan
    source: Address


@dataclass(frozen=True, slots=True)
class CurrentItemSet(Event):
    """A client set the current item; `restart` also resets the mission, its jump counters included."""

    seq: int
    source: Address
    restart: bool = False


@dataclass(frozen=True, slots=True)
class MissionServerOptions:
    """The properties by which vehicles differ.

    Attributes:
        limits: The largest number of items of each supported plan type.
        plan_ids: Send plan ids.
        home_first: Item 0 of a mission is the vehicle's home, whatever was uploaded there, and can be read
            while the mission is empty (ArduPilot).
        frames_of_locations: Keep the frames of items with a location only; others have GLOBAL (ArduPilot).
        plain_requests: Request items by MISSION_REQUEST, and accept either form of item (ArduPilot).
        float_answers: Answer MISSION_REQUEST with MISSION_ITEM to all clients.
        request_interval: The smallest time between two requests for an item, seconds: some clients count
            them.
    """

    limits: Mapping[int, int] = field(default_factory=lambda: DEFAULT_LIMITS)
    plan_ids: bool = True
    home_first: bool = False
    frames_of_locations: bool = False
    plain_requests: bool = False
    float_answers: bool = False
    request_interval: float = MIN_TIMEOUT


class MissionServer(Service):
    """The mission server of one vehicle.

    Args:
        local: The vehicle's autopilot.
        store: The storage of its plans; None: in memory.
        options: The properties by which vehicles differ.
        validate: Validates a complete plan.
        check: Validates an item.
        guided: Executes items that are no part of a plan; None: they are treated as part of an upload.
        store_elsewhere: Stores a validated plan on another device; None: it is stored at once.
    """

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
        options: MissionServerOptions | None = None,
        *,
        validate: Validate = lambda plan, source: _Result.ACCEPTED,
        check: Check = lambda plan_type, seq, item: _Result.ACCEPTED,
        guided: Guided | None = None,
        store_elsewhere: StoreElsewhere | None = None,
    ) -> None:
        super().__init__(local)
        self.store = store or PlanStore()
        self.options = options or MissionServerOptions()
        self.limits = {int(kind): min(limit, MAX_ITEMS) for kind, limit in self.options.limits.items()}
        self.home: MissionItem | None = None
        self.state: int = common.MissionState.NOT_STARTED
        #: MISSION_CURRENT.mission_mode: 1 while the vehicle flies the mission, 2 otherwise, 0 unknown.
        self.mode = 0
        self._validate, self._check, self._guided = validate, check, guided
        self._store_elsewhere = store_elsewhere
        self._clearing: dict[int, tuple[Address, int]] = {}
        self._current = 0
        #: The cached results of `plan`, which is called for every item, with their plans and home items.
        self._shown: dict[int, tuple[Plan, MissionItem | None, Plan]] = {}
        self._cleared: OrderedDict[Address, tuple[bytes, float]] = OrderedDict()
        self._uploads = UploadServer(
            self._complete,
            check,
            self._reply,
            plain_requests=self.options.plain_requests,
            request_interval=self.options.request_interval,
        )
        self._downloads = DownloadServer(
            self.plan,
            self._current_of,
            self._uploads.acknowledge,
            self._reply,
            home=self._first_item if self.options.home_first else None,
        )

    # Methods for the program

    def plan(self, plan_type: int) -> Plan:
        """Return the plan of a type as clients see it, with its id."""
        held = self.store.get(plan_type)
        made_of = self._shown.get(plan_type)
        if made_of is None or made_of[0] is not held or made_of[1] is not self.home:
            made_of = self._shown[plan_type] = (held, self.home, self._with_home_and_id(held))
        return made_of[2]

    def replace(self, plan: Plan) -> None:
        """Replace the plan of the same type by one of the program.

        Raises:
            InvalidArgumentError: The plan exceeds the limits.
        """
        if len(plan) > self.limits.get(plan.type, 0):
            raise InvalidArgumentError(
                f"a plan of type {plan.type} has at most {self.limits.get(plan.type, 0)} items here, "
                f"got {len(plan)}"
            )
        self._put(plan)

    def accept(self, plan: Plan, source: Address) -> int:
        """Validate a complete plan that came by other means, such as a file, and store it if accepted."""
        if len(plan) > self.limits.get(plan.type, -1):
            return _Result.NO_SPACE if plan.type in self.limits else _Result.UNSUPPORTED
        for seq, item in enumerate(plan.items):
            result = self._check(plan.type, seq, item)
            if result != _Result.ACCEPTED:
                return result
        outcome = self._complete(plan, source)
        return _Result.ACCEPTED if outcome is None else outcome[0]

    def finish_storing(self, plan: Plan, source: Address, result: int, now: float) -> None:
        """End what `store_elsewhere` began: acknowledge it, and keep the plan if the result is ACCEPTED."""
        plan_id = self._replace(plan, source) if result == _Result.ACCEPTED else 0
        ended = self._uploads.finish(plan.type, result, plan_id, now)
        if not ended and not plan.items and plan.type in self._clearing:
            self._uploads.acknowledge(*self._clearing.pop(plan.type), result)

    @property
    def current(self) -> int:
        """The number of the mission's current item."""
        return self._current

    def set_current(self, seq: int) -> None:
        """Set the current item and broadcast MISSION_CURRENT."""
        if not 0 <= seq < max(len(self.store.get(PlanType.MISSION)), 1):
            raise InvalidArgumentError(f"the mission has no item {seq}")
        self._current = seq
        self.send(self.current_message())

    def reached(self, seq: int) -> None:
        """Broadcast MISSION_ITEM_REACHED."""
        self.send(common.MissionItemReached(seq=seq))

    def current_message(self) -> common.MissionCurrent:
        """Return MISSION_CURRENT, which is sent on each change and should be streamed at a low rate."""
        count = len(self.store.get(PlanType.MISSION))
        ids = [self.plan(kind).plan_id for kind in PLAN_TYPES]
        return common.MissionCurrent(
            seq=self._current,
            total=max(count - self.options.home_first, 0) if count else NO_MISSION,
            mission_state=self.state if count else common.MissionState.NO_MISSION,
            mission_mode=self.mode,
            mission_id=ids[0],
            fence_id=ids[1],
            rally_points_id=ids[2],
        )

    def answer_commands(self, commands: CommandServer, touch: Callable[[MissionServer], None]) -> None:
        """Execute MAV_CMD_DO_SET_MISSION_CURRENT too; `touch` is the engine's."""

        def set_current(request: CommandRequest) -> common.MavResult:
            touch(self)
            return self._set_current_command(request)

        commands.support(common.MavCmd.DO_SET_MISSION_CURRENT, set_current)

    # Methods of a service

    def receive(self, packet: Packet, now: float) -> None:
        source = Address(packet.system, packet.component)
        match packet.message:
            case common.MissionRequestList(mission_type=kind) if self._supports(kind, source):
                self._downloads.list(source, int(kind))
            case common.MissionRequestInt(mission_type=kind, seq=seq) if self._supports(kind, source):
                self._downloads.request(source, int(kind), seq, as_float=False)
            case common.MissionRequest(mission_type=kind, seq=seq) if self._supports(kind, source):
                self._downloads.request(
                    source, int(kind), seq, as_float=self.options.float_answers or packet.version == 1
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

    def _with_home_and_id(self, held: Plan) -> Plan:
        plan = held
        if self.options.frames_of_locations:
            plan = Plan(held.type, tuple(map(_without_frame, held.items)))
        if self.options.home_first and held.type == PlanType.MISSION and self.home is not None and held.items:
            plan = Plan(held.type, (self.home, *plan.items[1:]))
        return plan.with_id(held.checksum() if self.options.plan_ids else 0)

    def _first_item(self) -> MissionItem:
        """Return item 0 of a mission that begins with home; its place is 0, 0 while home is unknown."""
        uploaded = self.plan(PlanType.MISSION).items
        if uploaded:
            return uploaded[0]
        return self.home or MissionItem(common.MavCmd.NAV_WAYPOINT, frame=common.MavFrame.GLOBAL)

    def _supports(self, kind: int, source: Address) -> bool:
        if kind not in self.limits:
            self._uploads.acknowledge(source, int(kind), _Result.UNSUPPORTED)
        return kind in self.limits

    def _item(self, source: Address, message: common.MissionItemInt | common.MissionItem, now: float) -> None:
        if self._guided is not None and message.current in GUIDED:
            result = self._guided(MissionItem.read(message), int(message.current))
            self._uploads.acknowledge(source, int(message.mission_type), result)
        else:
            self._uploads.receive_item(source, message, now)

    def _count(self, source: Address, message: common.MissionCount, raw: bytes, now: float) -> None:
        if message.count > self.limits[int(message.mission_type)]:
            self._uploads.acknowledge(source, int(message.mission_type), _Result.NO_SPACE)
        else:
            self._uploads.begin(source, message, raw, now)

    def _complete(self, plan: Plan, source: Address) -> tuple[int, int] | None:
        result = self._validate(plan, source)
        if result == _Result.ACCEPTED and self._store_elsewhere is not None:
            self._store_elsewhere(plan, source)
            return None
        return result, self._replace(plan, source) if result == _Result.ACCEPTED else 0

    def _replace(self, plan: Plan, source: Address) -> int:
        """Store a plan of a client; return its id."""
        self._put(plan)
        self.emit(PlanReplaced(plan, source))
        return self.plan(plan.type).plan_id

    def _put(self, plan: Plan) -> None:
        self.store.put(plan)
        self._downloads.changed(plan.type)
        if plan.type == PlanType.MISSION:
            self._current = next((seq for seq, item in enumerate(plan.items) if item.current), 0)
        self.send(self.current_message())

    def _clear(self, source: Address, kind: int, raw: bytes, now: float) -> None:
        known, at = self._cleared.get(source, (b"", 0.0))
        if (known == raw and now - at < DUPLICATE_WINDOW) or (source, kind) in self._clearing.values():
            return
        kinds = tuple(self.limits) if kind == PlanType.ALL else (kind,)
        result = self._check_clear(source, kinds)
        if result == _Result.ACCEPTED:
            self._cleared[source] = (raw, now)
            self._cleared.move_to_end(source)
            if len(self._cleared) > MAX_REMEMBERED:
                self._cleared.popitem(last=False)
            for each in kinds:
                self._uploads.drop(each)
                if self._store_elsewhere is not None:
                    self._clearing[each] = (source, kind)
                    self._store_elsewhere(Plan(each), source)
                else:
                    self._replace(Plan(each), source)
        if self._store_elsewhere is None or result != _Result.ACCEPTED:
            self._uploads.acknowledge(source, kind, result)

    def _check_clear(self, source: Address, kinds: tuple[int, ...]) -> int:
        for kind in kinds:
            upload = self._uploads.running(kind)
            if kind not in self.limits:
                return _Result.UNSUPPORTED
            if upload is not None and upload.source != source:
                return _Result.DENIED
            result = self._validate(Plan(kind), source)
            if result != _Result.ACCEPTED:
                return result
        return _Result.ACCEPTED

    def _set_current_message(self, source: Address, seq: int) -> None:
        if self._set_current(seq, source, restart=False):
            return
        text = f"Mission has no item {seq}"
        self.send(common.Statustext(severity=common.MavSeverity.WARNING, text=text))

    def _set_current_command(self, request: CommandRequest) -> common.MavResult:
        wanted, restart = request.command.param1, request.command.param2 == 1
        if not isfinite(wanted):
            return common.MavResult.DENIED
        seq = self._current if wanted == -1 else int(wanted)
        done = self._set_current(seq, request.source, restart=restart)
        return common.MavResult.ACCEPTED if done else common.MavResult.DENIED

    def _set_current(self, seq: int, source: Address, *, restart: bool) -> bool:
        if not 0 <= seq < len(self.store.get(PlanType.MISSION)):
            return False
        self.set_current(seq)
        self.emit(CurrentItemSet(seq, source, restart))
        return True

    def _current_of(self, plan_type: int) -> int:
        return self._current if plan_type == PlanType.MISSION else -1

    def _reply(self, message: Message, target: Address = BROADCAST) -> None:
        self.send(message, target)


def _without_frame(item: MissionItem) -> MissionItem:
    """Return an item as ArduPilot stores it: the frame belongs to the location, and is GLOBAL without one."""
    if item.command in commands_with_location():
        return item
    return replace(item, frame=int(common.MavFrame.GLOBAL))
