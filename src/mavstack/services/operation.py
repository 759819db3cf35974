"""An operation on a remote component, from its start to its result or its typed error, and its client.

A client runs any number of operations on one target and lends each of them its outbox. An operation waits
for answers (`receive`) and for its own timer (`self.timer`), and ends only by `finish` or `fail`. It fails
with its `timeout_error` if it makes no progress for `idle_timeout` seconds, or if it has not ended `timeout`
seconds after it was begun. When it is cancelled, `clean_up` releases the state that the remote component
keeps for it.

An operation of several steps is a `Procedure`: its `steps` are a generator that yields operations and is
resumed with their results, or with their errors raised in place, so that it reads from top to bottom.
"""

from __future__ import annotations

import logging
from abc import abstractmethod
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from mavstack.errors import InvalidStateError, MavstackError, RemoteCancelled, RemoteError, RemoteTimeout
from mavstack.services.addressing import Address
from mavstack.services.service import Event, HasRoom, Outgoing, Priority, Service, always_room, earliest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.dialects import Message
    from mavstack.errors import SystemIdConflictError
    from mavstack.wire import Packet

logger = logging.getLogger("mavstack.services")

#: Seconds after which a transfer without a timeout must have reached its minimum rate, and the longest
#: duration of such a transfer.
SLOW_START, MAX_DURATION = 120.0, 86400.0
#: The number of repetitions of an operation whose times are kept.
MAX_RETRY_TIMES = 100

Result = TypeVar("Result")
AnyOperation = TypeVar("AnyOperation", bound="Operation[Any]")


@dataclass(frozen=True, slots=True)
class OperationEnded(Event):
    """An operation has ended, with its result or its error."""

    operation: Operation[Any]


@dataclass(frozen=True, slots=True)
class Progress(Event):
    """A long operation made progress: `done` of `total` (0: not known yet), in the operation's own unit."""

    operation: Operation[Any]
    done: int
    total: int


class Operation(Generic[Result]):
    """An operation on one remote component.

    Args:
        description: The operation as a gerund or a command name, with the preposition that leads to the
            target, for errors and logs: "listing the logs of", "NAV_LAND on" (see `RemoteError`).
        timeout: Seconds for the whole operation; None sets no overall limit.
        idle_timeout: Seconds without progress after which the operation fails.
    """

    #: The error that the operation fails with when a timeout expires.
    timeout_error: ClassVar[type[RemoteTimeout]] = RemoteTimeout
    #: The smallest average progress per second, in the unit of the operation's progress; below it the
    #: operation fails. 0: no limit. See `deadline`.
    min_rate: ClassVar[float] = 0.0
    #: Ids of the messages that the operation receives in addition to those of its client.
    handles: frozenset[int] = frozenset()

    def __init__(self, description: str, *, timeout: float | None = None, idle_timeout: float = 10.0) -> None:
        self.description = description
        self.done = False
        self.error: MavstackError | None = None
        self.attempts = 0
        #: The times of the first repetitions, at most `MAX_RETRY_TIMES`.
        self.retry_times: list[float] = []
        self.timer: float | None = None
        self.parent: Operation[Any] | None = None
        self._result: Result | None = None
        self._timeout = timeout
        self._idle_timeout = idle_timeout
        self._timeout_at: float | None = None
        self._idle_timeout_at: float | None = None
        self._launched_at: float | None = None
        self._progress = 0
        self._client: Client | None = None

    def result(self) -> Result:
        """Return the result.

        Raises:
            RemoteError: The operation failed.
            LocalProtocolError: The operation failed because of an argument.
            InvalidStateError: The operation has not ended yet.
        """
        if self.error is not None:
            raise self.error
        if not self.done:
            raise InvalidStateError(f"the operation has not ended yet: {self}")
        return self._result  # type: ignore[return-value]

    @property
    def client(self) -> Client:
        """The client that runs the operation.

        Raises:
            InvalidStateError: The operation was not begun.
        """
        if self._client is None:
            raise InvalidStateError(f"the operation was not begun: {self}; pass it to its client's begin()")
        return self._client

    @property
    def target(self) -> Address:
        """The remote component."""
        return self.client.target

    @property
    def launched_at(self) -> float | None:
        """The time at which the operation was started; None: it waits behind another one."""
        return self._launched_at

    @property
    def has_timeout(self) -> bool:
        """True if the caller gave a timeout for the whole operation."""
        return self._timeout is not None

    def __str__(self) -> str:
        return self.description if self._client is None else f"{self.description} {self._client.target}"

    # Methods that an operation overrides

    @abstractmethod
    def start(self, now: float) -> None:
        """Send the first message and set the first timer."""

    def receive(self, packet: Packet, now: float) -> None:
        """Handle a packet from the target."""

    def handle_timeout(self, now: float) -> None:
        """Handle the expiry of `self.timer`, which was set back to None."""

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        """Yield the messages of a long transfer, one at a time while there is room."""
        return iter(())

    def clean_up(self, now: float) -> None:
        """Release the state that the remote component keeps, on cancellation and on timeouts."""

    def child_ended(self, child: Operation[Any], now: float) -> None:
        """Handle the end of an operation that this one began."""

    # Methods that an operation calls

    def send(self, message: Message, priority: Priority = Priority.CONTROL) -> None:
        """Send a message to the target; the operation fails if the message acts and may not be sent."""
        error = self.client.refusal(message, self.target, self.description)
        if error is None:
            self.client.send(message, self.target, priority)
        else:
            self.fail(error)

    def finish(self, result: Result) -> None:
        """End with a result."""
        if not self.done:
            self.done, self._result, self.timer = True, result, None

    def fail(self, error: MavstackError) -> None:
        """End with an error."""
        if not self.done:
            self.done, self.error, self.timer = True, error, None

    def report_progress(self, now: float, done: int = 0, total: int = 0) -> None:
        """Restart the idle timeout, and emit a `Progress` event if `done` or `total` is given.

        A child operation reports to its parent.
        """
        self._idle_timeout_at = now + self._idle_timeout
        self._progress = max(self._progress, done)
        if self.parent is not None:
            self.parent.report_progress(now, done, total)
        elif done or total:
            self.client.emit(Progress(self, done, total))

    def begin(self, child: AnyOperation, now: float) -> AnyOperation:
        """Begin another operation as a child of this one."""
        child.parent = self
        return self.client.begin(child, now)

    # Methods that a client calls

    def attach(self, client: Client, now: float) -> None:
        """Assign the operation to a client; `timeout` counts from here."""
        self._client = client
        self._timeout_at = None if self._timeout is None else now + self._timeout

    def launch(self, now: float) -> None:
        """Start; `idle_timeout` counts from here."""
        self._idle_timeout_at = now + self._idle_timeout
        self._launched_at = now
        self.start(now)

    @property
    def deadline(self) -> float | None:
        """The time at which the operation fails unless it makes progress.

        Without a `timeout`, a component that sends a little from time to time must not hold the caller for
        ever: after `SLOW_START` seconds the average progress must reach `min_rate`.
        """
        return earliest(self._timeout_at, self._idle_timeout_at, self._too_slow_at())

    def _too_slow_at(self) -> float | None:
        if not self.min_rate or self._timeout is not None or self._launched_at is None:
            return None
        return self._launched_at + min(SLOW_START + self._progress / self.min_rate, MAX_DURATION)

    def next_timeout(self) -> float | None:
        """Return the time of the next call of `tick`."""
        return earliest(self.timer, self.deadline)

    def tick(self, now: float) -> None:
        """Handle the timers that are due."""
        too_slow_at = self._too_slow_at()
        if too_slow_at is not None and now >= too_slow_at:
            self._run_out_of_time(now, "too slow, ", now - (self._launched_at or now))
        elif self._timeout_at is not None and now >= self._timeout_at and self._progress:
            self._run_out_of_time(now, "", self._timeout or 0.0)
        elif self.deadline is not None and now >= self.deadline:
            self.time_out(now)
        elif self.timer is not None and now >= self.timer:
            self.timer = None
            attempts = self.attempts
            self.handle_timeout(now)
            if self.attempts > max(attempts, 1):
                if len(self.retry_times) < MAX_RETRY_TIMES:
                    self.retry_times.append(now)
                logger.debug("%s: no answer, attempt %d", self, self.attempts)

    def time_out(self, now: float, answer: str = "no answer") -> None:
        """Fail with `timeout_error` after `clean_up`."""
        self._give_up(self.timeout_error, now, answer)

    def cancel(self, now: float, answer: str = "cancelled by the caller") -> None:
        """Fail with `RemoteCancelled` after `clean_up`."""
        self._give_up(RemoteCancelled, now, answer)

    def _run_out_of_time(self, now: float, reason: str, elapsed: float) -> None:
        answer = (
            f"{reason}only {self._progress} arrived in {round(elapsed, 1):g} s; timeout= allows more time"
        )
        self._give_up(self.timeout_error, now, answer, limit="timeout")

    def _give_up(self, error: type[RemoteError], now: float, answer: str, limit: str = "") -> None:
        if self.done:
            return
        # an operation that was never sent has nothing to clean up on the remote component
        if self._idle_timeout_at is not None:
            self.clean_up(now)
        target, attempts = str(self.target), self.attempts
        self.fail(error(self.description, target, attempts=attempts, answer=answer, limit=limit))


class Client(Service):
    """The client of a service for one target; component 0 in the target stands for any of the system."""

    def __init__(self, local: Address, target: Address) -> None:
        super().__init__(local)
        self.target = self.source_filter = target
        self._own_handles = self.handles
        #: Returns the error that forbids to send a message to a target, or None; the text describes the
        #: operation.
        self.refusal: Callable[[Message, Address, str], SystemIdConflictError | None] = _never
        self._running: list[Operation[Any]] = []
        self._waiting: deque[Operation[Any]] = deque()

    @property
    def busy(self) -> bool:
        """True while any operation has not ended."""
        return bool(self._running or self._waiting)

    def begin(self, operation: AnyOperation, now: float) -> AnyOperation:
        """Start an operation, or queue it behind those that it conflicts with."""
        operation.attach(self, now)
        self._waiting.append(operation)
        self._settle(now)
        return operation

    def cancel(self, operation: Operation[Any], now: float) -> None:
        """Cancel an operation, which ends with `RemoteCancelled`."""
        operation.cancel(now)
        for child in self._children_of(operation):
            child.cancel(now)
        self._settle(now)

    def time_out(self, operation: Operation[Any], now: float, answer: str) -> None:
        """End the current step of an operation with its timeout error; a procedure may begin another one."""
        step = operation
        while children := self._children_of(step):
            step = children[0]
        step.time_out(now, answer)
        self._settle(now)

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        """Return whether `new` must wait until `running` has ended; by default it does not."""
        return False

    def observe(self, packet: Packet, now: float) -> None:
        """Handle a packet of the target, whether it belongs to an operation or not."""

    def receive(self, packet: Packet, now: float) -> None:
        if not self.target.covers(Address(packet.system, packet.component)):
            return
        self.observe(packet, now)
        for operation in tuple(self._running):
            if not operation.done:
                operation.receive(packet, now)
        self._settle(now)

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        for operation in tuple(self._running):
            if not operation.done:
                yield from operation.bulk_messages(now, has_room)
        self._settle(now)
        while self._outbox:
            yield self._outbox.popleft()

    def handle_refusal(self, error: SystemIdConflictError, now: float) -> None:
        for operation in tuple(self._running):
            kind = type(error)
            operation.fail(kind(operation.description, str(operation.target), answer=error.answer))
        self._settle(now)

    def next_timeout(self) -> float | None:
        deadlines = (operation.deadline for operation in self._waiting)
        return earliest(*(operation.next_timeout() for operation in self._running), *deadlines)

    def handle_timeout(self, now: float) -> None:
        for operation in (*self._running, *self._waiting):
            if not operation.done:
                operation.tick(now)
        self._settle(now)

    def _settle(self, now: float) -> None:
        """Report ended operations and start waiting ones, until nothing changes."""
        changed = False
        while self._report_ended(now) or self._start_next(now):
            changed = True
        if changed:
            wanted = self._own_handles.union(*(operation.handles for operation in self._running))
            self.handles = self.handles if wanted == self.handles else wanted

    def _report_ended(self, now: float) -> bool:
        ended = [operation for operation in (*self._running, *self._waiting) if operation.done]
        self._running = [operation for operation in self._running if not operation.done]
        self._waiting = deque(operation for operation in self._waiting if not operation.done)
        for operation in ended:
            if operation.parent is None:
                self.emit(OperationEnded(operation))
            else:
                operation.parent.child_ended(operation, now)
            for child in self._children_of(operation):
                child.cancel(now)
        return bool(ended)

    def _start_next(self, now: float) -> bool:
        for operation in self._waiting:
            if not any(self._must_wait(operation, other) for other in self._running):
                self._waiting.remove(operation)
                self._running.append(operation)
                operation.launch(now)
                return True
        return False

    def _must_wait(self, new: Operation[Any], running: Operation[Any]) -> bool:
        return new.parent is not running and self.conflicts(new, running)

    def _children_of(self, operation: Operation[Any]) -> list[Operation[Any]]:
        return [
            child
            for child in (*self._running, *self._waiting)
            if child.parent is operation and not child.done
        ]


def _never(message: Message, target: Address, description: str) -> SystemIdConflictError | None:
    """Return None: outside of a node there is one vehicle."""
    return None
