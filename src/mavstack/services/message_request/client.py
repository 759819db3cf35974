"""The request of one message (guide: MAV_CMD_REQUEST_MESSAGE). It runs on the target's `CommandClient`.

    requested ── the message ────────────────► result, whether or not the ack arrived
      │ ├── ack ACCEPTED ──► waiting ── the message ──► result
      │ │                       └── timeout ──► requested again; finally MessageTimeout
      │ ├── ack UNSUPPORTED, DENIED or FAILED ──► the legacy command for that message ──► as above
      │ └── any other ack ──► CommandDenied
      └── no ack ──► MessageTimeout

If the message arrives first, the ack of the request is still in transit. Its command stays active until the
ack arrives, or would have been requested again: else the ack would be mistaken for the answer to the next
request.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

from mavstack.dialects import common
from mavstack.errors import CommandDenied, InvalidArgumentError, MessageTimeout
from mavstack.services.command import Command, CommandOperation
from mavstack.services.message_request.interval import message_id_of, name_of
from mavstack.services.message_request.legacy_requests import legacy_request
from mavstack.services.operation import Operation

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.dialects import Message
    from mavstack.services.message_request.legacy_requests import LegacyRequest
    from mavstack.wire import Packet

    Match: TypeAlias = Callable[[Any], bool]

#: The number of accepted requests after which a message that does not arrive is given up.
MAX_ROUNDS = 4
INITIAL_TIMEOUT = 1.0
MAX_PARAMS = 5

_TRY_LEGACY = frozenset({common.MavResult.UNSUPPORTED, common.MavResult.DENIED, common.MavResult.FAILED})


class _RequestCommand(CommandOperation):
    """The command of a request; after its cancellation it waits for its ack but is not repeated."""

    def __init__(self, command: Command) -> None:
        super().__init__(command)
        self._lingers = False

    def cancel(self, now: float, answer: str = "cancelled by the caller") -> None:
        self._lingers = True
        if self.timer is None or not self.attempts:
            super().cancel(now, answer)

    def handle_timeout(self, now: float) -> None:
        if self._lingers:
            super().cancel(now)
        else:
            super().handle_timeout(now)

    def clean_up(self, now: float) -> None:
        """Do nothing: the target has nothing to cancel."""


class RequestMessage(Operation[Any]):
    """The request of one message; the result is the message.

    Args:
        message: The message class or id.
        params: Params 2 to 6 of the command, such as an index or an id.
        match: Selects among several messages of that class; None accepts the first.
        timeout: Seconds for the whole operation; None sets no overall limit.
    """

    timeout_error = MessageTimeout

    def __init__(
        self,
        message: type[Message] | int,
        params: Sequence[float] = (),
        *,
        match: Match | None = None,
        timeout: float | None = None,
    ) -> None:
        super().__init__(f"requesting {name_of(message)} from", timeout=timeout, idle_timeout=30.0)
        self.message_id = message_id_of(message)
        self.handles = frozenset({self.message_id})
        if len(params) > MAX_PARAMS:
            raise InvalidArgumentError(
                f"a message request has at most {MAX_PARAMS} params (2 to 6), got {len(params)}"
            )
        self._params = tuple(params)
        self._match = match
        self._legacy: LegacyRequest | None = None
        self._denied: CommandDenied | None = None
        self._rounds = 0
        self._command_operation: CommandOperation | None = None

    def start(self, now: float) -> None:
        self._send_request(now)

    def receive(self, packet: Packet, now: float) -> None:
        if packet.message_id == self.message_id and (self._match is None or self._match(packet.message)):
            self.finish(packet.message)

    def handle_timeout(self, now: float) -> None:
        if self._rounds < MAX_ROUNDS:
            self._send_request(now)
        elif not self._try_legacy(now):
            self.time_out(now, "the request was accepted, but the message did not arrive")

    def child_ended(self, child: Operation[Any], now: float) -> None:
        if self.done or child is not self._command_operation:
            return
        self.attempts += child.attempts
        self._command_operation = None
        self.report_progress(now)
        if child.error is None:
            self.timer = now + INITIAL_TIMEOUT * 2 ** (self._rounds - 1)
        elif isinstance(child.error, CommandDenied):
            self._refused(child.error, now)
        else:
            self.time_out(now)

    def _send_request(self, now: float) -> None:
        self._rounds += 1
        self._command_operation = self.begin(_RequestCommand(self._command()), now)

    def _command(self) -> Command:
        if self._legacy is not None:
            return self._legacy.to_command(self._params[0] if self._params else 0.0)
        second, third, fourth, fifth, sixth = (*self._params, 0.0, 0.0, 0.0, 0.0, 0.0)[:5]
        kind = float(self.message_id)
        return Command(common.MavCmd.REQUEST_MESSAGE, kind, second, third, fourth, fifth, sixth)

    def _refused(self, error: CommandDenied, now: float) -> None:
        if error.code in _TRY_LEGACY and self._try_legacy(now):
            self._denied = error
            return
        # UNSUPPORTED only means that the target lacks the legacy command. It refused the current command
        # before, and that refusal is more specific.
        first = self._denied if error.code == common.MavResult.UNSUPPORTED and self._denied else error
        denied = CommandDenied(
            self.description, str(self.target), attempts=self.attempts, answer=first.answer, code=first.code
        )
        denied.detail = first.detail
        self.fail(denied)

    def _try_legacy(self, now: float) -> bool:
        legacy = legacy_request(self.message_id)
        if legacy is None or self._legacy is not None:
            return False
        self._legacy, self._rounds = legacy, 0
        self._send_request(now)
        return True
