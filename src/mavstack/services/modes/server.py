"""The mode server (guide: standard modes; the commands DO_SET_MODE and DO_SET_STANDARD_MODE; SET_MODE).

The server has the modes of the vehicle and the current one. A client's request is checked by `may_enter`, the
program's policy: a text refuses it, and is sent to the client with the prefix `refusal`. The program enters
modes itself by `enter`, such as in a failsafe; then `intended` keeps the commanded mode.

    REQUEST_MESSAGE AVAILABLE_MODES, 0     all modes, one message each, as the link has room
    REQUEST_MESSAGE AVAILABLE_MODES, n     the mode of that index, the first being 1
    REQUEST_MESSAGE CURRENT_MODE           sent at once; else every two seconds and on each change
    modes changed                          AVAILABLE_MODES_MONITOR at once, then every ten seconds
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import BROADCAST, Address, message_ids
from mavstack.services.modes.available import AvailableMode
from mavstack.services.modes.names import PX4, mode_name, px4_custom_mode
from mavstack.services.service import Event, Outgoing, Priority, Service, earliest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.services.command import CommandRequest, CommandServer
    from mavstack.services.service import HasRoom
    from mavstack.wire import Packet

CURRENT_INTERVAL = 2.0
MONITOR_INTERVAL = 10.0
#: The largest number of modes: `number_modes` and `mode_index` are bytes.
MAX_MODES = 255
#: The largest number of concurrent listings; further ones are answered TEMPORARILY_REJECTED.
MAX_LISTINGS = 16
MODES_ID, CURRENT_ID, MONITOR_ID = (
    kind.__mavlink_row__[0]
    for kind in (common.AvailableModes, common.CurrentMode, common.AvailableModesMonitor)
)
OFFERED = frozenset({MODES_ID, CURRENT_ID, MONITOR_ID})
_CUSTOM = common.MavModeFlag.CUSTOM_MODE_ENABLED
_STATUSTEXT_BYTES = 50


@dataclass(frozen=True, slots=True)
class ModeChanged(Event):
    """The vehicle entered another mode; `source` requested it, None if the program did."""

    mode: AvailableMode
    previous: AvailableMode
    source: Address | None


@dataclass(frozen=True, slots=True)
class ModeRefused(Event):
    """A client requested a mode and was refused."""

    custom_mode: int
    source: Address
    reason: str


#: The program's policy: returns the reason why the mode may not be entered now, or None.
MayEnter: TypeAlias = "Callable[[AvailableMode, Address], str | None]"


class ModeServer(Service):
    """The modes of one vehicle, and the current one."""

    # Registered handlers execute the commands. Their ids are listed here so that the engine sends the
    # messages of the handlers afterwards.
    handles = message_ids(common.SetMode, common.CommandLong, common.CommandInt)

    def __init__(
        self,
        local: Address,
        modes: Sequence[AvailableMode],
        current: int,
        *,
        autopilot: int = common.MavAutopilot.GENERIC,
        may_enter: MayEnter | None = None,
        refusal: str = "Mode refused: ",
    ) -> None:
        super().__init__(local)
        self.autopilot = autopilot
        self.sequence = 0
        self._may_enter = may_enter
        self._refusal = refusal
        self._modes = _checked(modes)
        self._current = self._intended = self._named(current)
        self._listings: dict[Address, deque[int]] = {}
        #: False while CURRENT_MODE is not sent without a request, as over a link of high latency.
        self.enabled = True
        self._current_due = 0.0
        self._monitor_due: float | None = None

    # Methods for the program

    @property
    def modes(self) -> tuple[AvailableMode, ...]:
        """The modes of the vehicle."""
        return self._modes

    @property
    def current(self) -> AvailableMode:
        """The current mode; HEARTBEAT carries its `custom_mode`."""
        return self._current

    @property
    def intended(self) -> AvailableMode:
        """The mode that was last commanded."""
        return self._intended

    def enter(self, custom_mode: int, now: float, *, commanded: bool = False) -> None:
        """Enter another mode: by the vehicle's own decision, or as a side effect of a command."""
        mode = self._named(custom_mode)
        if commanded:
            self._intended = mode
        self._change(mode, None, now)

    def offer(self, modes: Sequence[AvailableMode], now: float) -> None:
        """Replace the set of modes; clients are notified to list them again."""
        self._modes = _checked(modes)
        self._listings.clear()
        self.sequence = self.sequence % 255 + 1
        self._monitor_due = now
        self.handle_timeout(now)

    def register(self, commands: CommandServer) -> None:
        """Register the command handlers; requests of other messages go to the previous handler."""
        commands.support(common.MavCmd.DO_SET_MODE, self.set_mode)
        commands.support(common.MavCmd.DO_SET_STANDARD_MODE, self.set_standard_mode)
        others = commands.handler_of(common.MavCmd.REQUEST_MESSAGE)

        def requested(request: CommandRequest) -> common.MavResult | tuple[common.MavResult, int] | None:
            if others is None or _integer(request.command.param1) in OFFERED:
                return self.requested(request)
            return others(request)

        commands.support(common.MavCmd.REQUEST_MESSAGE, requested)

    # Command handlers

    def set_mode(self, request: CommandRequest) -> common.MavResult:
        """Handle DO_SET_MODE."""
        command = request.command
        flags, first, second = (_integer(value) for value in (command.param1, command.param2, command.param3))
        if flags is None or first is None or not flags & _CUSTOM:
            return self._refuse(0, request.source, "only custom modes can be set")
        custom_mode = px4_custom_mode(first, second or 0) if self.autopilot == PX4 else first
        return self._asked_for(custom_mode, request.source, request.received_at)

    def set_standard_mode(self, request: CommandRequest) -> common.MavResult:
        """Handle DO_SET_STANDARD_MODE; a missing standard mode is answered FAILED, as the guide says."""
        wanted = _integer(request.command.param1)
        found = [mode for mode in self._modes if wanted and mode.standard_mode == wanted]
        if not found:
            return self._refuse(0, request.source, f"there is no standard mode {wanted}")
        return self._asked_for(found[0].custom_mode, request.source, request.received_at)

    def requested(self, request: CommandRequest) -> common.MavResult:
        """Handle REQUEST_MESSAGE of the mode messages."""
        message_id = _integer(request.command.param1)
        if message_id == CURRENT_ID:
            self.send(self._current_mode(), request.source)
        elif message_id == MONITOR_ID:
            self.send(common.AvailableModesMonitor(seq=self.sequence), request.source)
        elif message_id == MODES_ID:
            return self._list(_integer(request.command.param2), request.source)
        else:
            return common.MavResult.UNSUPPORTED
        return common.MavResult.ACCEPTED

    # Methods of a service

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.SetMode(target_system=self.local.system, base_mode=flags, custom_mode=wanted):
                source = Address(packet.system, packet.component)
                if flags & _CUSTOM:
                    self._asked_for(int(wanted), source, now)
                else:
                    self._refuse(int(wanted), source, "only custom modes can be set")

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        for target in tuple(self._listings):
            waiting = self._listings[target]
            while waiting and has_room(target, Priority.BULK):
                index = waiting.popleft()
                message = self._modes[index - 1].to_message(index, len(self._modes))
                yield Outgoing(message, target, Priority.BULK)
            if not waiting:
                del self._listings[target]

    def next_timeout(self) -> float | None:
        return earliest(self._current_due, self._monitor_due)

    def handle_timeout(self, now: float) -> None:
        if now >= self._current_due:
            self._current_due = now + CURRENT_INTERVAL
            if self.enabled:
                self.send(self._current_mode(), BROADCAST, Priority.STREAM)
        if self._monitor_due is not None and now >= self._monitor_due:
            self._monitor_due = now + MONITOR_INTERVAL
            self.send(common.AvailableModesMonitor(seq=self.sequence), BROADCAST, Priority.STREAM)

    # Internals

    def _asked_for(self, custom_mode: int, source: Address, now: float) -> common.MavResult:
        found = [mode for mode in self._modes if mode.custom_mode == custom_mode]
        if not found:
            return self._refuse(custom_mode, source, f"there is no mode {custom_mode}")
        reason = self._may_enter(found[0], source) if self._may_enter else None
        if reason is not None:
            return self._refuse(custom_mode, source, reason)
        self._intended = found[0]
        self._change(found[0], source, now)
        return common.MavResult.ACCEPTED

    def _refuse(self, custom_mode: int, source: Address, reason: str) -> common.MavResult:
        self.emit(ModeRefused(custom_mode, source, reason))
        text = f"{self._refusal}{reason}".encode()[:_STATUSTEXT_BYTES].decode(errors="ignore")
        self.send(common.Statustext(severity=common.MavSeverity.WARNING, text=text), source)
        return common.MavResult.FAILED

    def _change(self, mode: AvailableMode, source: Address | None, now: float) -> None:
        previous, self._current = self._current, mode
        if previous != mode:
            self.emit(ModeChanged(mode, previous, source))
            self._current_due = now
            self.handle_timeout(now)

    def _list(self, index: int | None, target: Address) -> common.MavResult:
        if index is None or index > len(self._modes):
            return common.MavResult.DENIED
        if target not in self._listings and len(self._listings) >= MAX_LISTINGS:
            return common.MavResult.TEMPORARILY_REJECTED
        waiting = self._listings.setdefault(target, deque())
        wanted = range(1, len(self._modes) + 1) if index == 0 else (index,)
        waiting.extend(number for number in wanted if number not in waiting)
        return common.MavResult.ACCEPTED

    def _current_mode(self) -> common.CurrentMode:
        return common.CurrentMode(
            standard_mode=self._current.standard_mode,
            custom_mode=self._current.custom_mode,
            intended_custom_mode=self._intended.custom_mode,
        )

    def _named(self, custom_mode: int) -> AvailableMode:
        """Return a mode by its number; an unlisted one, such as that of an ended script, has no name."""
        found = (mode for mode in self._modes if mode.custom_mode == custom_mode)
        return next(found, AvailableMode(custom_mode))


def modes_of(
    autopilot: int, vehicle: int, custom_modes: Sequence[int], standard: dict[int, int] | None = None
) -> list[AvailableMode]:
    """Return modes by their numbers, with the autopilot's names; `standard` maps them to standard modes."""
    return [
        AvailableMode(
            number,
            mode_name(autopilot, vehicle, number) or f"mode {number}",
            (standard or {}).get(number, common.MavStandardMode.NON_STANDARD),
        )
        for number in custom_modes
    ]


def _checked(modes: Sequence[AvailableMode]) -> tuple[AvailableMode, ...]:
    if not 0 < len(modes) <= MAX_MODES:
        raise InvalidArgumentError(f"a vehicle must have 1 to {MAX_MODES} modes, got {len(modes)}")
    if len({mode.custom_mode for mode in modes}) != len(modes):
        raise InvalidArgumentError("two modes have the same custom_mode")
    return tuple(modes)


def _integer(value: float) -> int | None:
    """Return the mode number in a command's parameter; None if it is not a valid one."""
    return int(value) if 0 <= value < 1 << 32 else None
