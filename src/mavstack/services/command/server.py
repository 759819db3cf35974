"""The command server (guide: command protocol).

Each supported command has a handler; others are answered UNSUPPORTED, unless they were addressed to all
components: then only the autopilot answers, so that a camera's refusal is not mistaken for the vehicle's. A
handler returns its MAV_RESULT at once, or `None` for a long command: then IN_PROGRESS is sent, the program
reports with `progress` and ends the command with `complete`. While it runs, the same command is answered
TEMPORARILY_REJECTED, except for a repetition of the running request (COMMAND_LONG with a higher
confirmation), which gets the progress. A repetition of an answered request gets the same answer and is not
executed again.

Disarming is never held up by an arming that still runs: the arming is answered CANCELLED, its cancellation is
requested, and the disarming is executed (`Command.supersedes`). A late copy of the arming does not arm then.
"""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids, target_of
from mavstack.services.command.client import PROGRESS_UNKNOWN
from mavstack.services.command.command import Command
from mavstack.services.service import Event, Service
from mavstack.services.timing import DUPLICATE_WINDOW

if TYPE_CHECKING:
    from mavstack.wire import Packet

AUTOPILOT = common.MavComponent.AUTOPILOT1
#: Seconds for which a repetition is recognised.
REPETITION_WINDOW = 30.0
MAX_ANSWERED = 256
#: The number of answers kept for each source and command, so that a late copy of an older request is not
#: executed again.
MAX_ANSWERS_OF_COMMAND = 4
#: Seconds between two IN_PROGRESS if the program reports no progress.
PROGRESS_INTERVAL = 2.0


@dataclass(eq=False, slots=True)
class CommandRequest:
    """A received command.

    Attributes:
        command: The command.
        source: The component that sent it.
        received_at: When it was received, Unix seconds.
        confirmation: The `confirmation` of a COMMAND_LONG; None for a COMMAND_INT.
        raw: The bytes of the packet.
        addressed: True if it was addressed to this component, and not to all.
    """

    command: Command
    source: Address
    received_at: float
    confirmation: int | None
    raw: bytes = field(repr=False)
    addressed: bool
    percent: int = PROGRESS_UNKNOWN
    progress_due: float = field(default=0.0, repr=False)

    def is_copy_of(self, earlier: CommandRequest) -> bool:
        """Return whether this is `earlier`, duplicated by the network."""
        return self.raw == earlier.raw and self.received_at - earlier.received_at < DUPLICATE_WINDOW

    def repeats(self, earlier: CommandRequest) -> bool:
        """Return whether this is `earlier`, repeated by its client or duplicated by the network."""
        if self.raw == earlier.raw:
            return self.is_copy_of(earlier)
        return (
            bool(self.confirmation)
            and self.received_at - earlier.received_at < REPETITION_WINDOW
            and repr(self.command) == repr(earlier.command)
        )


@dataclass(frozen=True, slots=True)
class CommandStarted(Event):
    """A long command started; report with `progress`, end with `complete`."""

    request: CommandRequest


@dataclass(frozen=True, slots=True)
class CommandCancelRequested(Event):
    """A long command is to be cancelled.

    The client wants it: end the command with CANCELLED, or continue. Or a later command superseded it, and
    it is no longer in `running`: end its work.
    """

    request: CommandRequest


#: The handler of a command: returns its MAV_RESULT, a pair of MAV_RESULT and `result_param2`, or None for a
#: long command.
Handler: TypeAlias = Callable[[CommandRequest], "common.MavResult | tuple[common.MavResult, int] | None"]
_Answer: TypeAlias = "tuple[CommandRequest, common.CommandAck]"


class CommandServer(Service):
    """The command server of one component."""

    handles = message_ids(common.CommandLong, common.CommandInt, common.CommandCancel)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._handlers: dict[int, Handler] = {}
        self._running: dict[int, CommandRequest] = {}
        self._answered: OrderedDict[tuple[Address, int], deque[_Answer]] = OrderedDict()

    def support(self, command: int, handler: Handler) -> None:
        """Register the handler of a command."""
        self._handlers[int(command)] = handler

    def handler_of(self, command: int) -> Handler | None:
        """Return the handler of a command, for another one that delegates to it."""
        return self._handlers.get(int(command))

    @property
    def supported(self) -> frozenset[int]:
        """The commands that have a handler."""
        return frozenset(self._handlers)

    @property
    def running(self) -> tuple[CommandRequest, ...]:
        """The running long commands."""
        return tuple(self._running.values())

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.CommandLong() as message:
                self._requested(self._request(message, message.confirmation, packet, now), now)
            case common.CommandInt() as message:
                self._requested(self._request(message, None, packet, now), now)
            case common.CommandCancel(command=command):
                request = self._running.get(int(command))
                if request is not None and request.source == (packet.system, packet.component):
                    self.emit(CommandCancelRequested(request))

    def progress(self, request: CommandRequest, percent: int, now: float) -> None:
        """Report the progress of a long command, 0 to 100 percent."""
        if self._running.get(request.command.command) is request:
            request.percent = percent
            self._send_progress(request, now)

    def complete(self, request: CommandRequest, result: int, detail: int = 0, *, progress: int = 0) -> None:
        """End a long command with a MAV_RESULT, `result_param2` and `progress` of COMMAND_ACK. Idempotent."""
        if self._running.get(request.command.command) is request:
            del self._running[request.command.command]
            self._answer(request, result, detail, progress)

    def next_timeout(self) -> float | None:
        return min((request.progress_due for request in self._running.values()), default=None)

    def handle_timeout(self, now: float) -> None:
        for request in self._running.values():
            if now >= request.progress_due:
                self._send_progress(request, now)

    def _request(
        self,
        message: common.CommandLong | common.CommandInt,
        confirmation: int | None,
        packet: Packet,
        now: float,
    ) -> CommandRequest:
        source = Address(packet.system, packet.component)
        target = target_of(message)
        addressed = target.system == self.local.system and (
            target.component == self.local.component or self.local.component == AUTOPILOT
        )
        return CommandRequest(
            Command.read(message), source, now, confirmation, raw=packet.raw, addressed=addressed
        )

    def _requested(self, request: CommandRequest, now: float) -> None:
        self._end_superseded(request)
        running = self._running.get(request.command.command)
        if running is not None:
            self._repeated(request, running, now)
            return
        if (answer := self._earlier_answer(request)) is not None:
            self.send(answer, request.source)
            return
        handler = self._handlers.get(request.command.command)
        if handler is None:
            if request.addressed:
                self._answer(request, common.MavResult.UNSUPPORTED, 0)
            return
        self._execute(handler, request, now)

    def _end_superseded(self, request: CommandRequest) -> None:
        for running in self.running:
            if request.command.command in self._handlers and request.command.supersedes(running.command):
                self.complete(running, common.MavResult.CANCELLED)
                self.emit(CommandCancelRequested(running))

    def _earlier_answer(self, request: CommandRequest) -> common.CommandAck | None:
        """Return the answer to the request that this one repeats; None if it is a new one.

        A command of other parameters between them makes a repetition by confirmation a new request, unless
        the earlier one was cancelled.
        """
        answers = self._answered.get((request.source, request.command.command), ())
        for age, (earlier, ack) in enumerate(reversed(answers)):
            may_be_repeated = age == 0 or ack.result == common.MavResult.CANCELLED
            if request.is_copy_of(earlier) or (may_be_repeated and request.repeats(earlier)):
                return ack
        return None

    def _repeated(self, request: CommandRequest, running: CommandRequest, now: float) -> None:
        if running.source == request.source and request.repeats(running):
            self._send_progress(running, now)
        else:
            self.send(_ack(request, common.MavResult.TEMPORARILY_REJECTED, 0, 0), request.source)

    def _execute(self, handler: Handler, request: CommandRequest, now: float) -> None:
        outcome = handler(request)
        if outcome is None:
            self._running[request.command.command] = request
            self._send_progress(request, now)
            self.emit(CommandStarted(request))
            return
        result, detail = outcome if isinstance(outcome, tuple) else (outcome, 0)
        self._answer(request, result, detail)

    def _send_progress(self, request: CommandRequest, now: float) -> None:
        request.progress_due = now + PROGRESS_INTERVAL
        self.send(_ack(request, common.MavResult.IN_PROGRESS, request.percent, 0), request.source)

    def _answer(self, request: CommandRequest, result: int, detail: int, progress: int = 0) -> None:
        ack = _ack(request, result, progress, detail)
        key = (request.source, request.command.command)
        self._answered.setdefault(key, deque(maxlen=MAX_ANSWERS_OF_COMMAND)).append((request, ack))
        self._answered.move_to_end(key)
        if len(self._answered) > MAX_ANSWERED:
            self._answered.popitem(last=False)
        self.send(ack, request.source)


def _ack(request: CommandRequest, result: int, progress: int, detail: int) -> common.CommandAck:
    return common.CommandAck(
        command=request.command.command,
        result=result,
        progress=progress,
        result_param2=detail,
        target_system=request.source.system,
        target_component=request.source.component,
    )
