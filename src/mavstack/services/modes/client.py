"""Setting a mode and listing modes (guide: standard modes; MAV_CMD_DO_SET_MODE; SET_MODE).

    HEARTBEAT tells the kind of vehicle ── DO_SET_MODE ── accepted ── HEARTBEAT tells the mode ──► done
                                             │              └── it never does ──► ModeTimeout
                                             ├── UNSUPPORTED, or no answer ── SET_MODE
                                             └── refused ──► CommandDenied

An acknowledgement says that the vehicle will change its mode, its HEARTBEAT that it has: so that is awaited.
PX4 takes the main and the sub mode as two parameters, others take `custom_mode` whole. Old autopilots know
the message SET_MODE only, which nobody acknowledges.

The operations run on the target's CommandClient, since acknowledgements do not tell whose command they mean.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout, ModeTimeout, RemoteDenied, RemoteTimeout
from mavstack.services.addressing import message_ids
from mavstack.services.command import Command, CommandOperation
from mavstack.services.modes.available import AvailableMode
from mavstack.services.modes.names import PX4, mode_name, mode_names, mode_number, px4_modes_of
from mavstack.services.operation import Operation, Procedure

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from mavstack.wire import Packet

#: How long to wait for the first HEARTBEAT, and for one that tells the new mode.
HEARTBEAT_TIMEOUT = 5.0
MODE_CHANGE_TIMEOUT = 10.0
COMMAND_TIMEOUT = 30.0
#: How often the message SET_MODE is sent while nothing confirms it, and CURRENT_MODE asked for.
REPEAT_INTERVAL = 1.0
#: How long after the last AVAILABLE_MODES the gaps are asked for.
LISTING_QUIET = 1.5
LISTING_ROUNDS = 8

_KEPT = common.MavModeFlag.SAFETY_ARMED | common.MavModeFlag.HIL_ENABLED
_CUSTOM = common.MavModeFlag.CUSTOM_MODE_ENABLED
_AVAILABLE_MODES_ID = next(iter(message_ids(common.AvailableModes)))
_CURRENT_MODE_ID = next(iter(message_ids(common.CurrentMode)))
Result = TypeVar("Result")


class Until(Operation[None]):
    """Wait until something holds that packets bring about; `meanwhile` is done now and then."""

    timeout_error = ModeTimeout

    def __init__(
        self,
        description: str,
        holds: Callable[[], bool],
        *,
        idle_timeout: float,
        meanwhile: Callable[[], None] | None = None,
    ) -> None:
        super().__init__(description, idle_timeout=idle_timeout)
        self._holds = holds
        self._meanwhile = meanwhile

    def start(self, now: float) -> None:
        self.handle_timeout(now)

    def receive(self, packet: Packet, now: float) -> None:
        if self._holds():
            self.finish(None)

    def handle_timeout(self, now: float) -> None:
        if self._holds():
            self.finish(None)
        elif self._meanwhile is not None:
            self._meanwhile()
            self.attempts += 1
            self.timer = now + REPEAT_INTERVAL


class _ModeProcedure(Procedure[Result]):
    """A procedure that watches the target's HEARTBEAT and CURRENT_MODE."""

    handles = message_ids(common.Heartbeat, common.CurrentMode)

    def __init__(self, description: str, *, timeout: float | None) -> None:
        super().__init__(description, timeout=timeout)
        self.heartbeat: common.Heartbeat | None = None
        self.current: common.CurrentMode | None = None

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.Heartbeat() as message if message.autopilot != common.MavAutopilot.INVALID:
                self.heartbeat = message
            case common.CurrentMode() as message:
                self.current = message

    def until(
        self,
        holds: Callable[[], bool],
        *,
        idle_timeout: float = MODE_CHANGE_TIMEOUT,
        meanwhile: Callable[[], None] | None = None,
    ) -> Until:
        """A step that waits for what HEARTBEAT or CURRENT_MODE tell."""
        return Until(self.description, holds, idle_timeout=idle_timeout, meanwhile=meanwhile)

    def entered(self, custom_mode: int) -> bool:
        """Whether the last HEARTBEAT tells that mode."""
        heartbeat = self.heartbeat
        return heartbeat is not None and heartbeat.custom_mode == custom_mode

    def first_heartbeat(self) -> Generator[Operation[Any], Any, common.Heartbeat]:
        """Steps: know what the vehicle is."""
        try:
            yield self.until(lambda: self.heartbeat is not None, idle_timeout=HEARTBEAT_TIMEOUT)
        except ModeTimeout:
            raise ModeTimeout(
                self.description, str(self.target), answer="no HEARTBEAT of an autopilot"
            ) from None
        assert self.heartbeat is not None  # noqa: S101 (what was waited for)
        return self.heartbeat

    def confirmed(self, holds: Callable[[], bool]) -> Generator[Operation[Any], Any, None]:
        """Steps: wait until the accepted mode is entered."""
        try:
            yield self.until(holds)
        except ModeTimeout:
            raise self._not_entered() from None

    def _not_entered(self) -> ModeTimeout:
        heartbeat = self.heartbeat
        name = "nothing" if heartbeat is None else name_in(heartbeat)
        answer = f"accepted, but not entered: the vehicle tells {name}"
        return ModeTimeout(self.description, str(self.target), attempts=self.attempts, answer=answer)


class SetMode(_ModeProcedure[int]):
    """Enter a mode, by its name or its `custom_mode`; the result is the `custom_mode` that was entered."""

    def __init__(self, mode: str | int, *, timeout: float | None = 60.0) -> None:
        super().__init__(f"setting mode {mode} on", timeout=timeout)
        self.mode = mode

    def steps(self) -> Generator[Operation[Any], Any, int]:
        heartbeat = yield from self.first_heartbeat()
        wanted = self.mode
        if isinstance(wanted, str):
            wanted = yield from self._number(wanted, heartbeat)
        self.heartbeat = None  # what was told before the command proves nothing
        try:
            yield CommandOperation(_command(wanted, heartbeat), timeout=COMMAND_TIMEOUT)
        except (CommandDenied, CommandTimeout) as error:
            yield from self._old_way(wanted, heartbeat, error)
        else:
            yield from self.confirmed(lambda: self.entered(wanted))
        return wanted

    def _number(self, name: str, heartbeat: common.Heartbeat) -> Generator[Operation[Any], Any, int]:
        """Steps: the number of a name, from the tables or, for modes that come and go, from the vehicle."""
        number = mode_number(int(heartbeat.autopilot), int(heartbeat.type), name)
        if number is not None:
            return number
        try:
            listed = yield ListModes()
        except (CommandDenied, RemoteTimeout):
            listed = ()
        for mode in listed:
            if mode.name.casefold() == name.casefold():
                return int(mode.custom_mode)
        known = mode_names(int(heartbeat.autopilot), int(heartbeat.type)).values()
        told = [mode.name for mode in listed] or known
        names = ", ".join(dict.fromkeys(told)) or "none that is known"
        raise RemoteDenied(
            self.description,
            str(self.target),
            answer=f"there is no such mode; it has {names}",
            code=common.MavResult.DENIED,
        )

    def _old_way(
        self, wanted: int, heartbeat: common.Heartbeat, error: CommandDenied | CommandTimeout
    ) -> Generator[Operation[Any], Any, None]:
        """Steps: the message SET_MODE, for those that do not know the command."""
        if isinstance(error, CommandDenied) and error.code != common.MavResult.UNSUPPORTED:
            raise error
        message = common.SetMode(
            target_system=self.target.system, base_mode=_base_mode(heartbeat), custom_mode=wanted
        )
        try:
            yield self.until(lambda: self.entered(wanted), meanwhile=lambda: self.send(message))
        except ModeTimeout:
            raise error from None


class SetStandardMode(_ModeProcedure[int]):
    """Enter a standard mode (MAV_STANDARD_MODE); the result is its `custom_mode` on this vehicle."""

    def __init__(self, standard_mode: int, *, timeout: float | None = 60.0) -> None:
        super().__init__(f"setting standard mode {_standard_name(standard_mode)} on", timeout=timeout)
        self.standard_mode = int(standard_mode)

    def steps(self) -> Generator[Operation[Any], Any, int]:
        command = common.MavCmd.DO_SET_STANDARD_MODE
        yield CommandOperation(Command(command, param1=float(self.standard_mode)))
        self.current = None
        for _ in range(3):
            try:
                yield self.until(self._in_it, idle_timeout=3.0)
            except ModeTimeout:
                yield from self._ask()
            else:
                break
        else:
            yield from self.confirmed(self._in_it)
        assert self.current is not None  # noqa: S101 (what was waited for)
        return int(self.current.custom_mode)

    def _ask(self) -> Generator[Operation[Any], Any, None]:
        try:
            yield CommandOperation(
                Command(common.MavCmd.REQUEST_MESSAGE, param1=float(_CURRENT_MODE_ID)), timeout=5.0
            )
        except (CommandDenied, CommandTimeout):
            return  # it may still be streamed

    def _in_it(self) -> bool:
        return self.current is not None and self.current.standard_mode == self.standard_mode


class ListModes(Procedure[tuple[AvailableMode, ...]]):
    """All modes that the vehicle has, by AVAILABLE_MODES; what got lost is asked for again by its index."""

    handles = message_ids(common.AvailableModes, common.AvailableModesMonitor)

    def __init__(self, *, timeout: float | None = 60.0) -> None:
        super().__init__("listing the modes of", timeout=timeout)
        self._found: dict[int, AvailableMode] = {}
        self._total = 0
        self._sequence: int | None = None
        self._heard_at = 0.0

    def steps(self) -> Generator[Operation[Any], Any, tuple[AvailableMode, ...]]:
        yield self._request(0)
        for _ in range(LISTING_ROUNDS):
            yield from self._wait_until_quiet()
            if self._complete():
                return tuple(self._found[index] for index in sorted(self._found))
            for index in self._missing():
                if index == 0 or index not in self._found:
                    yield self._request(index)
        answer = f"{len(self._found)} of {self._total or 'unknown'} modes came"
        raise ModeTimeout(self.description, str(self.target), attempts=self.attempts, answer=answer)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.AvailableModes(number_modes=total, mode_index=index) as message:
                self._take(AvailableMode.read(message), index, total, now)
            case common.AvailableModesMonitor(seq=sequence):
                if self._sequence != sequence:  # the first one too: it may tell of a change just made
                    self._found.clear()
                self._sequence = sequence

    def _take(self, mode: AvailableMode, index: int, total: int, now: float) -> None:
        if not 0 < index <= total:
            return
        if total != self._total or self._found.get(index, mode) != mode:
            self._found.clear()  # the modes changed while they were listed
        self._total = total
        self._found[index] = mode
        self._heard_at = now
        self.report_progress(now, len(self._found), total)

    def _wait_until_quiet(self) -> Generator[Operation[Any], Any, None]:
        """Steps: wait while messages come in, no longer than they do."""
        while not self._complete():
            before = self._heard_at
            try:
                yield Until(self.description, self._complete, idle_timeout=LISTING_QUIET)
            except ModeTimeout:
                if self._heard_at == before:
                    return

    def _complete(self) -> bool:
        return 0 < self._total == len(self._found)

    def _missing(self) -> list[int]:
        """Indexes to ask for; 0, all of them, if nothing is known."""
        if not self._found:
            return [0]
        return [index for index in range(1, self._total + 1) if index not in self._found]

    @staticmethod
    def _request(index: int) -> CommandOperation:
        command = common.MavCmd.REQUEST_MESSAGE
        return CommandOperation(Command(command, param1=float(_AVAILABLE_MODES_ID), param2=float(index)))


def name_in(heartbeat: common.Heartbeat) -> str:
    """The mode that a HEARTBEAT tells, in words."""
    custom_mode = int(heartbeat.custom_mode)
    name = mode_name(int(heartbeat.autopilot), int(heartbeat.type), custom_mode)
    return name or f"mode {custom_mode}"


def _base_mode(heartbeat: common.Heartbeat) -> int:
    """`base_mode` of a request; who reads more of it than one flag must not disarm by it."""
    return int(heartbeat.base_mode) & int(_KEPT) | int(_CUSTOM)


def _command(custom_mode: int, heartbeat: common.Heartbeat) -> Command:
    main, sub = px4_modes_of(custom_mode) if heartbeat.autopilot == PX4 else (custom_mode, 0)
    return Command(
        common.MavCmd.DO_SET_MODE, param1=float(_base_mode(heartbeat)), param2=float(main), param3=float(sub)
    )


def _standard_name(standard_mode: int) -> str:
    try:
        return common.MavStandardMode(standard_mode).name
    except ValueError:
        return str(int(standard_mode))
