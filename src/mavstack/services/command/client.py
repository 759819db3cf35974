"""The command client (guide: command protocol).

    sent ── ack ACCEPTED ─────────────► result
      │ ├── ack IN_PROGRESS ──► running ── ack ──► result or CommandDenied
      │ │                          └── silence ──► CommandTimeout
      │ ├── ack *_ONLY, UNSUPPORTED_MAV_FRAME ──► sent in the other form, once
      │ └── any other ack ──► CommandDenied
      └── silence ──► sent again, up to ATTEMPTS times ──► CommandTimeout

An acknowledgement names the command but carries no number, so two commands of the same id to one target
queue. Disarming does not wait for an arming: it cancels the arming, and ignores acknowledgements that may be
those of the arming. TEMPORARILY_REJECTED in answer to a repetition may mean that the first request is in
progress and its IN_PROGRESS was lost: then the client waits for its end.

A repetition after the measured round trip is wrong for commands that the vehicle executes before it answers.
ArduPilot calibrates its gyroscopes for half a second or more: it would do it again, and its second answer
would be taken for that of the next command. A repeated reboot arrives after the boot. These commands are
repeated after `SLOW_TIMEOUT`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout
from mavstack.services.addressing import Address, message_ids
from mavstack.services.operation import AnyOperation, Client, Operation
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.services.command.command import Command
    from mavstack.wire import Packet

ATTEMPTS = 8
#: Seconds after the last COMMAND_ACK with IN_PROGRESS after which a command in progress fails.
PROGRESS_TIMEOUT = 30.0
#: Commands that a vehicle may execute before it answers them.
SLOW_COMMANDS = frozenset(
    {
        common.MavCmd.PREFLIGHT_CALIBRATION,
        common.MavCmd.PREFLIGHT_STORAGE,
        common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN,
    }
)
#: Seconds after which such a command is sent again.
SLOW_TIMEOUT = 5.0
#: `progress` of an acknowledgement without progress.
PROGRESS_UNKNOWN = 255

_OTHER_FORM = frozenset(
    {
        common.MavResult.COMMAND_LONG_ONLY,
        common.MavResult.COMMAND_INT_ONLY,
        common.MavResult.COMMAND_UNSUPPORTED_MAV_FRAME,
    }
)


@dataclass(frozen=True, slots=True)
class CommandResult:
    """The acknowledgement of an accepted command.

    Attributes:
        result: The MAV_RESULT.
        detail: The `result_param2`.
        attempts: The number of requests that were sent.
    """

    result: int
    detail: int
    attempts: int


class CommandOperation(Operation[CommandResult]):
    """One command, repeated until it is acknowledged.

    Args:
        command: The command.
        timeout: Seconds for the whole operation; None sets no overall limit.
        progress_timeout: Seconds without IN_PROGRESS after which a command in progress fails.
    """

    timeout_error = CommandTimeout

    def __init__(
        self, command: Command, *, timeout: float | None = None, progress_timeout: float = PROGRESS_TIMEOUT
    ) -> None:
        super().__init__(f"{command.name} on", timeout=timeout, idle_timeout=30.0)
        self.command = command
        self._form = command
        self._in_progress = False
        self._other_form_tried = False
        self._follows_cancelled = False
        self._progress_timeout = progress_timeout
        self._sent_in_form = 0
        self._sent_at = 0.0

    def supersede(self, other: CommandOperation, now: float) -> None:
        """Cancel another operation, if this command supersedes its command."""
        if self.command.supersedes(other.command):
            other.cancel(now, f"superseded by {self.command.name}")
            self._follows_cancelled = self.command.command == other.command.command

    def start(self, now: float) -> None:
        self._transmit(now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.CommandAck(command=command) as ack if command == self.command.command:
                if not self._answers_cancelled(ack):
                    self._acknowledged(ack, now)

    def handle_timeout(self, now: float) -> None:
        if self._in_progress:
            self.time_out(now, "started, then no further answer")
        elif self.attempts >= ATTEMPTS:
            self.time_out(now)
        else:
            self._transmit(now)

    def clean_up(self, now: float) -> None:
        target = self.target
        self.send(
            common.CommandCancel(
                target_system=target.system, target_component=target.component, command=self.command.command
            )
        )

    def _transmit(self, now: float) -> None:
        if self._form.frame is None:
            self.send(self._form.to_long(self.target, confirmation=min(self._sent_in_form, 255)))
        else:
            self.send(self._form.to_int(self.target))
        self.attempts += 1
        self._sent_in_form += 1
        self._sent_at = now
        self.timer = now + (SLOW_TIMEOUT if self._slow else self._round_trip.timeout(self._sent_in_form))

    def _answers_cancelled(self, ack: common.CommandAck) -> bool:
        """Return whether an acknowledgement may be that of the superseded command."""
        late_progress = ack.result == common.MavResult.IN_PROGRESS and self._sent_in_form == 1
        return self._follows_cancelled and (late_progress or ack.result == common.MavResult.CANCELLED)

    def _acknowledged(self, ack: common.CommandAck, now: float) -> None:
        if self._sent_in_form == 1 and not self._in_progress and not self._slow:
            self._round_trip.add_sample(now - self._sent_at)
        if ack.result == common.MavResult.ACCEPTED:
            self.finish(CommandResult(int(ack.result), ack.result_param2, self.attempts))
        elif ack.result == common.MavResult.IN_PROGRESS:
            self._progressed(ack.progress, now)
        elif ack.result == common.MavResult.TEMPORARILY_REJECTED and self._may_be_in_progress():
            self._progressed(PROGRESS_UNKNOWN, now)
        elif ack.result in _OTHER_FORM and not self._other_form_tried:
            self._try_other_form(now)
        else:
            self._refused(ack)

    def _may_be_in_progress(self) -> bool:
        return self._in_progress or self._sent_in_form > 1

    def _progressed(self, percent: int, now: float) -> None:
        self._in_progress = True
        known = 0 if percent == PROGRESS_UNKNOWN else min(percent, 100)
        self._idle_timeout = self._progress_timeout + 1.0
        self.report_progress(now, known, 100)
        self.timer = now + self._progress_timeout

    def _try_other_form(self, now: float) -> None:
        self._other_form_tried = True
        other = None if self._form.frame is not None else self._form.to_int(self.target).frame
        self._form = self._form.in_frame(other)
        self._sent_in_form = 0
        self._transmit(now)

    def _refused(self, ack: common.CommandAck) -> None:
        result = ack.result
        answer = result.name if isinstance(result, common.MavResult) else f"result {int(result)}"
        error = CommandDenied(
            self.description, str(self.target), attempts=self.attempts, answer=answer, code=int(result)
        )
        error.detail = ack.result_param2
        self.fail(error)

    @property
    def _slow(self) -> bool:
        return self.command.command in SLOW_COMMANDS

    @property
    def _round_trip(self) -> RoundTrip:
        client = self.client
        return client.round_trip if isinstance(client, CommandClient) else RoundTrip()


class CommandClient(Client):
    """The command client of one component."""

    handles = message_ids(common.CommandAck)

    def __init__(self, local: Address, target: Address) -> None:
        super().__init__(local, target)
        self.round_trip = RoundTrip(initial=1.0, minimum=0.2, maximum=1.5)

    def command(self, command: Command, now: float, *, timeout: float | None = None) -> CommandOperation:
        """Send a command; the operation's result is a `CommandResult`."""
        return self.begin(CommandOperation(command, timeout=timeout), now)

    def begin(self, operation: AnyOperation, now: float) -> AnyOperation:
        """Start an operation, or queue it; a command that supersedes others cancels them first."""
        if isinstance(operation, CommandOperation):
            for other in (*self._running, *self._waiting):
                if isinstance(other, CommandOperation):
                    operation.supersede(other, now)
        return super().begin(operation, now)

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        return (
            isinstance(new, CommandOperation)
            and isinstance(running, CommandOperation)
            and new.command.command == running.command.command
        )
