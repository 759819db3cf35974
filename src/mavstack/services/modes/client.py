"""The mode client: setting a mode, and listing modes (guide: standard modes; DO_SET_MODE; SET_MODE).

    HEARTBEAT tells the vehicle type ── DO_SET_MODE ── accepted ── HEARTBEAT tells the mode ──► result
                                            │              └── it never does ──► ModeTimeout
                                            ├── UNSUPPORTED, or no answer ── SET_MODE
                                            └── refused ──► CommandDenied

An acknowledgement says that the vehicle accepted the mode, its HEARTBEAT that it entered it: the operation
waits for the latter. PX4 takes the main and the sub mode as two parameters, others take `custom_mode` as one.
Old autopilots support only the message SET_MODE, which is not acknowledged.

The operations run on the target's CommandClient, since acknowledgements do not name the sender of the
command.
"""

from __future__ import annotations

from contextlib import suppress
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout, ModeTimeout, RemoteDenied, RemoteTimeout
from mavstack.services.addressing import message_ids
from mavstack.services.command import Command, CommandOperation
from mavstack.services.modes.available import AvailableMode
from mavstack.services.modes.names import (
    PX4,
    listed_name,
    mode_name,
    mode_names,
    mode_number,
    px4_modes_of,
    same_name,
)
from mavstack.services.operation import Operation
from mavstack.services.procedure import Procedure

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping

    from mavstack.wire import Packet

#: Seconds to wait for the first HEARTBEAT.
HEARTBEAT_TIMEOUT = 5.0
#: Seconds to wait for a HEARTBEAT with the new mode.
MODE_CHANGE_TIMEOUT = 10.0
COMMAND_TIMEOUT = 30.0
#: Seconds to wait for the effect of SET_MODE after the answer UNSUPPORTED: ArduPilot 4.1 sends this answer
#: not only for an unknown command, but also for modes that it lacks or does not enter now.
UNSUPPORTED_TIMEOUT = 3.0
#: Seconds between two SET_MODE without confirmation, and between two requests for CURRENT_MODE.
REPEAT_INTERVAL = 1.0
#: Seconds without a further AVAILABLE_MODES after which missing ones are requested.
LISTING_IDLE_TIMEOUT = 1.5
MAX_LISTING_ROUNDS = 8
#: Timeout in seconds of the lookup of a name that the tables lack, on a vehicle that still has the set of
#: modes with which it started; ArduCopter 4.7 needs seven seconds to list all of its modes.
LOOKUP_TIMEOUT = 2.0

_KEPT = common.MavModeFlag.SAFETY_ARMED | common.MavModeFlag.HIL_ENABLED
_CUSTOM = common.MavModeFlag.CUSTOM_MODE_ENABLED
_AVAILABLE_MODES_ID = next(iter(message_ids(common.AvailableModes)))
_CURRENT_MODE_ID = next(iter(message_ids(common.CurrentMode)))
Result = TypeVar("Result")


class WaitUntil(Operation[None]):
    """The wait for a condition that packets bring about; `repeat` is called at an interval repeat."""

    timeout_error = ModeTimeout

    def __init__(
        self,
        description: str,
        condition: Callable[[], bool],
        *,
        idle_timeout: float,
        repeat: Callable[[], None] | None = None,
    ) -> None:
        super().__init__(description, idle_timeout=idle_timeout)
        self._condition = condition
        self._repeat = repeat

    def start(self, now: float) -> None:
        self.handle_timeout(now)

    def receive(self, packet: Packet, now: float) -> None:
        if self._condition():
            self.finish(None)

    def handle_timeout(self, now: float) -> None:
        if self._condition():
            self.finish(None)
        elif self._repeat is not None:
            self._repeat()
            self.attempts += 1
            self.timer = now + REPEAT_INTERVAL


class _ModeProcedure(Procedure[Result]):
    """The base of procedures that observe the target's HEARTBEAT and CURRENT_MODE."""

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

    def wait_until(
        self,
        condition: Callable[[], bool],
        *,
        idle_timeout: float = MODE_CHANGE_TIMEOUT,
        repeat: Callable[[], None] | None = None,
    ) -> WaitUntil:
        """Return a step that waits for a condition on HEARTBEAT or CURRENT_MODE."""
        return WaitUntil(self.description, condition, idle_timeout=idle_timeout, repeat=repeat)

    def entered(self, custom_mode: int) -> bool:
        """Return whether the last HEARTBEAT has that mode."""
        heartbeat = self.heartbeat
        return heartbeat is not None and heartbeat.custom_mode == custom_mode

    def first_heartbeat(self) -> Generator[Operation[Any], Any, common.Heartbeat]:
        """Wait for the HEARTBEAT of the autopilot."""
        try:
            yield self.wait_until(lambda: self.heartbeat is not None, idle_timeout=HEARTBEAT_TIMEOUT)
        except ModeTimeout:
            raise ModeTimeout(
                self.description, str(self.target), answer="no HEARTBEAT of an autopilot"
            ) from None
        assert self.heartbeat is not None  # noqa: S101 (the condition of the wait)
        return self.heartbeat

    def confirmed(self, condition: Callable[[], bool]) -> Generator[Operation[Any], Any, None]:
        """Wait until the accepted mode is entered."""
        try:
            yield self.wait_until(condition)
        except ModeTimeout:
            raise self._not_entered() from None

    def _not_entered(self) -> ModeTimeout:
        heartbeat = self.heartbeat
        name = "no mode" if heartbeat is None else name_in(heartbeat)
        answer = f"accepted, but not entered: the vehicle reports {name}"
        return ModeTimeout(self.description, str(self.target), attempts=self.attempts, answer=answer)


class SetMode(_ModeProcedure[int]):
    """The setting of a mode, by its name or its `custom_mode`; the result is the entered `custom_mode`.

    Args:
        mode: The name or the number.
        reported: The names of modes that the vehicle listed before, by number.
        changed: True if the vehicle's set of modes changed since it started: a name that the tables do not
            have is then looked up for as long as a listing takes, else for a moment only.
        timeout: Seconds for the whole operation; None sets no overall limit.
    """

    def __init__(
        self,
        mode: str | int,
        *,
        reported: Mapping[int, str] = MappingProxyType({}),
        changed: bool = False,
        timeout: float | None = 60.0,
    ) -> None:
        super().__init__(f"setting mode {mode} on", timeout=timeout)
        self.mode = mode
        self._reported = reported
        self._lookup_timeout = None if changed else LOOKUP_TIMEOUT

    def steps(self) -> Generator[Operation[Any], Any, int]:
        heartbeat = yield from self.first_heartbeat()
        wanted = self.mode
        if isinstance(wanted, str):
            wanted = yield from self._number(wanted, heartbeat)
        self.heartbeat = None  # only a HEARTBEAT after the command proves the new mode
        try:
            yield CommandOperation(_command(wanted, heartbeat), timeout=COMMAND_TIMEOUT)
        except (CommandDenied, CommandTimeout) as error:
            yield from self._send_set_mode(wanted, heartbeat, error)
        else:
            yield from self.confirmed(lambda: self.entered(wanted))
        return wanted

    def _number(self, name: str, heartbeat: common.Heartbeat) -> Generator[Operation[Any], Any, int]:
        """Look up the number of a name, in the tables or, for dynamic modes, on the vehicle."""
        kind = int(heartbeat.autopilot), int(heartbeat.type)
        number = mode_number(*kind, name)
        if number is not None:
            return number
        for number, reported in self._reported.items():
            if same_name(reported, name):
                return number
        lookup = _FindMode(name, timeout=self._lookup_timeout)
        with suppress(CommandDenied, RemoteTimeout):  # an incomplete list may include the mode
            yield lookup
        for mode in lookup.found:
            if same_name(mode.name, name):
                return int(mode.custom_mode)
        listed = [listed_name(*kind, mode.custom_mode, mode.name) for mode in lookup.found]
        available = listed if lookup.complete else [*mode_names(*kind).values(), *listed]
        names = ", ".join(dict.fromkeys(available)) or "no known modes"
        raise RemoteDenied(
            self.description,
            str(self.target),
            answer=f"there is no such mode; the vehicle has {names}",
            code=common.MavResult.DENIED,
        )

    def _send_set_mode(
        self, wanted: int, heartbeat: common.Heartbeat, error: CommandDenied | CommandTimeout
    ) -> Generator[Operation[Any], Any, None]:
        """Send the message SET_MODE, for autopilots that do not support the command."""
        if isinstance(error, CommandDenied) and error.code != common.MavResult.UNSUPPORTED:
            raise error
        message = common.SetMode(
            target_system=self.target.system, base_mode=_base_mode(heartbeat), custom_mode=wanted
        )
        idle_timeout = UNSUPPORTED_TIMEOUT if isinstance(error, CommandDenied) else MODE_CHANGE_TIMEOUT
        try:
            yield self.wait_until(
                lambda: self.entered(wanted), idle_timeout=idle_timeout, repeat=lambda: self.send(message)
            )
        except ModeTimeout:
            raise error from None


class SetStandardMode(_ModeProcedure[int]):
    """The setting of a MAV_STANDARD_MODE; the result is its `custom_mode` on this vehicle."""

    def __init__(self, standard_mode: int, *, timeout: float | None = 60.0) -> None:
        super().__init__(f"setting standard mode {_standard_name(standard_mode)} on", timeout=timeout)
        self.standard_mode = int(standard_mode)

    def steps(self) -> Generator[Operation[Any], Any, int]:
        command = common.MavCmd.DO_SET_STANDARD_MODE
        yield CommandOperation(Command(command, param1=float(self.standard_mode)))
        self.current = None
        for _ in range(3):
            try:
                yield self.wait_until(self._is_entered, idle_timeout=3.0)
            except ModeTimeout:
                yield from self._request_current_mode()
            else:
                break
        else:
            yield from self.confirmed(self._is_entered)
        assert self.current is not None  # noqa: S101 (the condition of the wait)
        return int(self.current.custom_mode)

    def _request_current_mode(self) -> Generator[Operation[Any], Any, None]:
        try:
            yield CommandOperation(
                Command(common.MavCmd.REQUEST_MESSAGE, param1=float(_CURRENT_MODE_ID)), timeout=5.0
            )
        except (CommandDenied, CommandTimeout):
            return  # the vehicle may still stream the mode

    def _is_entered(self) -> bool:
        return self.current is not None and self.current.standard_mode == self.standard_mode


class ListModes(Procedure[tuple[AvailableMode, ...]]):
    """The listing of all modes by AVAILABLE_MODES; lost ones are requested by index."""

    handles = message_ids(common.AvailableModes, common.AvailableModesMonitor)

    def __init__(self, *, timeout: float | None = 60.0) -> None:
        super().__init__("listing the modes of", timeout=timeout)
        self._found: dict[int, AvailableMode] = {}
        self._total = 0
        self._sequence: int | None = None
        self._received_at = 0.0

    def steps(self) -> Generator[Operation[Any], Any, tuple[AvailableMode, ...]]:
        yield self._request(0)
        for _ in range(MAX_LISTING_ROUNDS):
            yield from self._wait_until_quiet()
            if self._complete():
                return self.found
            for index in self._missing():
                if index == 0 or index not in self._found:
                    yield self._request(index)
        answer = f"{len(self._found)} of {self._total or 'unknown'} modes arrived"
        raise ModeTimeout(self.description, str(self.target), attempts=self.attempts, answer=answer)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.AvailableModes(number_modes=total, mode_index=index) as message:
                self._add(AvailableMode.read(message), index, total, now)
            case common.AvailableModesMonitor(seq=sequence):
                # also for the first message, which may announce a recent change
                if self._sequence != sequence:
                    self._found.clear()
                self._sequence = sequence

    def _add(self, mode: AvailableMode, index: int, total: int, now: float) -> None:
        if not 0 < index <= total:
            return
        if total != self._total or self._found.get(index, mode) != mode:
            self._found.clear()  # the modes changed during the listing
        self._total = total
        self._found[index] = mode
        self._received_at = now
        self.report_progress(now, len(self._found), total)

    @property
    def found(self) -> tuple[AvailableMode, ...]:
        """The modes that arrived, by index."""
        return tuple(self._found[index] for index in sorted(self._found))

    @property
    def complete(self) -> bool:
        """True if all modes arrived."""
        return 0 < self._total == len(self._found)

    def _wait_until_quiet(self) -> Generator[Operation[Any], Any, None]:
        """Wait as long as messages arrive."""
        while not self._complete():
            before = self._received_at
            try:
                yield WaitUntil(self.description, self._complete, idle_timeout=LISTING_IDLE_TIMEOUT)
            except ModeTimeout:
                if self._received_at == before:
                    return

    def _complete(self) -> bool:
        """Return whether the listing may end."""
        return self.complete

    def _missing(self) -> list[int]:
        """Return the indexes to request; 0 means all."""
        if not self._found:
            return [0]
        return [index for index in range(1, self._total + 1) if index not in self._found]

    @staticmethod
    def _request(index: int) -> CommandOperation:
        command = common.MavCmd.REQUEST_MESSAGE
        return CommandOperation(Command(command, param1=float(_AVAILABLE_MODES_ID), param2=float(index)))


class _FindMode(ListModes):
    """A listing that ends as soon as a mode with some name arrived."""

    def __init__(self, name: str, *, timeout: float | None) -> None:
        super().__init__(timeout=timeout)
        self._name = name

    def _complete(self) -> bool:
        return self.complete or any(same_name(mode.name, self._name) for mode in self._found.values())


def name_in(heartbeat: common.Heartbeat) -> str:
    """Return the name of the mode in a HEARTBEAT."""
    custom_mode = int(heartbeat.custom_mode)
    name = mode_name(int(heartbeat.autopilot), int(heartbeat.type), custom_mode)
    return name or f"mode {custom_mode}"


def _base_mode(heartbeat: common.Heartbeat) -> int:
    """Return the `base_mode` of a request; it keeps the armed flag, which some autopilots evaluate."""
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
