"""Asking for a message, once (guide: MAV_CMD_REQUEST_MESSAGE). It runs on the target's `CommandClient`.

    asked ── the message ────────────────────► result, whether or not the ack came
      │ ├── ack ACCEPTED ──► waiting ── the message ──► result
      │ │                       └── silence ──► asked anew; after the last time MessageTimeout
      │ ├── ack UNSUPPORTED, DENIED or FAILED ──► the legacy command for that message ──► as above
      │ └── any other ack ──► CommandDenied
      └── no ack ──► MessageTimeout

A request whose message came first still has an ack on its way. Its command lingers until that ack is there,
or would have been sent again: else the ack would be taken for the answer to the next request.
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

#: How often a message is asked for whose request was accepted, but which did not come.
MAX_ROUNDS = 4
INITIAL_TIMEOUT = 1.0
MAX_PARAMS = 5

_TRY_LEGACY = frozenset({common.MavResult.UNSUPPORTED, common.MavResult.DENIED, common.MavResult.FAILED})


class _Ask(CommandOperation):
    """The command of a request; given up, it stays for its ack but is not sent again."""

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
        """There is nothing to cancel at the other end."""


class RequestMessage(Operation[Any]):
    """One message of the target; `params` are params 2 to 6 of the command, `match` chooses among several."""

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
            raise InvalidArgumentError(f"a request has params 2 to 6, not {len(params)} of them")
        self._params = tuple(params)
        self._match = match
        self._legacy: LegacyRequest | None = None
        self._denied: CommandDenied | None = None
        self._rounds = 0
        self._asking: CommandOperation | None = None

    def start(self, now: float) -> None:
        self._ask(now)

    def receive(self, packet: Packet, now: float) -> None:
        if packet.message_id == self.message_id and (self._match is None or self._match(packet.message)):
            self.finish(packet.message)

    def handle_timeout(self, now: float) -> None:
        if self._rounds < MAX_ROUNDS:
            self._ask(now)
        elif not self._try_legacy(now):
            self.time_out(now, "the request was accepted, but the message did not come")

    def child_ended(self, child: Operation[Any], now: float) -> None:
        if self.done or child is not self._asking:
            return
        self.attempts += child.attempts
        self._asking = None
        self.report_progress(now)
        if child.error is None:
            self.timer = now + INITIAL_TIMEOUT * 2 ** (self._rounds - 1)
        elif isinstance(child.error, CommandDenied):
            self._refused(child.error, now)
        else:
            self.time_out(now)

    def _ask(self, now: float) -> None:
        self._rounds += 1
        self._asking = self.begin(_Ask(self._command()), now)

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
        # A peer without the legacy command refused the newer one: that refusal says more.
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
        self._ask(now)
        return True
