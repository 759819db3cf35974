"""Answering commands (guide: command protocol).

A handler stands for each command that is supported; any other is answered UNSUPPORTED, unless it went to all
components: then only the autopilot says so, lest a camera's no is taken for the vehicle's. A handler returns
its MAV_RESULT at once, or `None` for a long one: then IN_PROGRESS is sent, the program reports with
`progress` and ends it with `complete`. While it runs, the same command is answered TEMPORARILY_REJECTED, but
a repetition of the very request that is running (COMMAND_LONG with a higher confirmation) hears how far
it is, and a repetition of one that was just answered hears the same answer and is not carried out again.
"""

from __future__ import annotations

from collections import OrderedDict
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
#: For so long a repetition is recognised as one.
MEMORY = 30.0
MAX_REMEMBERED = 256
#: How often IN_PROGRESS is said again if the program reports nothing new.
PROGRESS_INTERVAL = 2.0


@dataclass(eq=False, slots=True)
class CommandRequest:
    """A command that someone sent; `confirmation` is None if it came as COMMAND_INT.

    `addressed` says that it was meant for this component and not for all that hear it.
    """

    command: Command
    source: Address
    received_at: float
    confirmation: int | None
    raw: bytes = field(repr=False)
    addressed: bool
    percent: int = PROGRESS_UNKNOWN
    progress_due: float = field(default=0.0, repr=False)

    def repeats(self, earlier: CommandRequest) -> bool:
        """Whether this is `earlier`, sent again by a client that heard no answer, or doubled on its way."""
        age = self.received_at - earlier.received_at
        if self.raw == earlier.raw:
            return age < DUPLICATE_WINDOW
        return bool(self.confirmation) and age < MEMORY and repr(self.command) == repr(earlier.command)


@dataclass(frozen=True, slots=True)
class CommandStarted(Event):
    """A long command began; report with `progress`, end with `complete`."""

    request: CommandRequest


@dataclass(frozen=True, slots=True)
class CommandCancelRequested(Event):
    """The sender wants a long command to stop; end it with CANCELLED, or go on."""

    request: CommandRequest


#: What carries out a command: its MAV_RESULT, that and `result_param2`, or None for a long one.
Handler: TypeAlias = Callable[[CommandRequest], "common.MavResult | tuple[common.MavResult, int] | None"]


class CommandServer(Service):
    """Answers the commands that one component supports."""

    handles = message_ids(common.CommandLong, common.CommandInt, common.CommandCancel)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._handlers: dict[int, Handler] = {}
        self._running: dict[int, CommandRequest] = {}
        self._answered: OrderedDict[tuple[Address, int], tuple[CommandRequest, common.CommandAck]] = (
            OrderedDict()
        )

    def support(self, command: int, handler: Handler) -> None:
        """Carry out `command` by `handler` from now on."""
        self._handlers[int(command)] = handler

    def handler_of(self, command: int) -> Handler | None:
        """What carries out `command` now, for a handler that takes over some of its cases."""
        return self._handlers.get(int(command))

    @property
    def supported(self) -> frozenset[int]:
        """The commands that have a handler."""
        return frozenset(self._handlers)

    @property
    def running(self) -> tuple[CommandRequest, ...]:
        """The long commands that have not ended."""
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
        """Tell the sender how far a long command is, 0 to 100."""
        if self._running.get(request.command.command) is request:
            request.percent = percent
            self._say_progress(request, now)

    def complete(self, request: CommandRequest, result: int, detail: int = 0) -> None:
        """Tell the sender how a long command ended; ending it twice does nothing."""
        if self._running.get(request.command.command) is request:
            del self._running[request.command.command]
            self._answer(request, result, detail)

    def next_timeout(self) -> float | None:
        return min((request.progress_due for request in self._running.values()), default=None)

    def handle_timeout(self, now: float) -> None:
        for request in self._running.values():
            if now >= request.progress_due:
                self._say_progress(request, now)

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
        running = self._running.get(request.command.command)
        if running is not None:
            self._requested_again(request, running, now)
            return
        earlier = self._answered.get((request.source, request.command.command))
        if earlier and request.repeats(earlier[0]):
            self.send(earlier[1], request.source)
            return
        handler = self._handlers.get(request.command.command)
        if handler is None:
            if request.addressed:
                self._answer(request, common.MavResult.UNSUPPORTED, 0)
            return
        self._carry_out(handler, request, now)

    def _requested_again(self, request: CommandRequest, running: CommandRequest, now: float) -> None:
        if running.source == request.source and request.repeats(running):
            self._say_progress(running, now)
        else:
            self.send(_ack(request, common.MavResult.TEMPORARILY_REJECTED, 0, 0), request.source)

    def _carry_out(self, handler: Handler, request: CommandRequest, now: float) -> None:
        outcome = handler(request)
        if outcome is None:
            self._running[request.command.command] = request
            self._say_progress(request, now)
            self.emit(CommandStarted(request))
            return
        result, detail = outcome if isinstance(outcome, tuple) else (outcome, 0)
        self._answer(request, result, detail)

    def _say_progress(self, request: CommandRequest, now: float) -> None:
        request.progress_due = now + PROGRESS_INTERVAL
        self.send(_ack(request, common.MavResult.IN_PROGRESS, request.percent, 0), request.source)

    def _answer(self, request: CommandRequest, result: int, detail: int) -> None:
        ack = _ack(request, result, 0, detail)
        key = (request.source, request.command.command)
        self._answered[key] = (request, ack)
        self._answered.move_to_end(key)
        if len(self._answered) > MAX_REMEMBERED:
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
