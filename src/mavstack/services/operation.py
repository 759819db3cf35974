"""What a client asks of another component: an operation, from its start to its result or its typed error.

A client holds any number of operations toward one target and lends each of them its outbox. An operation
waits for answers (`receive`) and for its own timer (`self.timeout`), and ends by `finish` or `fail`, never
otherwise: if nothing moves for `patience` seconds, or `limit` seconds have gone by since it was asked for,
it fails with its `timeout_error`. Cancelling lets it leave the other end clean (`clean_up`).

An operation of several steps is a `Procedure`: its `steps` are a generator that yields operations and gets
their results, or their errors raised in place, so that it reads like the story it is.
"""

from __future__ import annotations

from abc import abstractmethod
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from mavstack.errors import MavstackError, RemoteCancelled, RemoteError, RemoteTimeout
from mavstack.services.addressing import Address
from mavstack.services.service import Event, HasRoom, Outgoing, Priority, Service, always_room, earliest

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator

    from mavstack.dialects import Message
    from mavstack.wire import Packet

Result = TypeVar("Result")
AnyOperation = TypeVar("AnyOperation", bound="Operation[Any]")


@dataclass(frozen=True, slots=True)
class OperationEnded(Event):
    """An operation has its result or its error."""

    operation: Operation[Any]


@dataclass(frozen=True, slots=True)
class Progress(Event):
    """A long operation moved on: `done` of `total` (0: not known yet), in the operation's own unit."""

    operation: Operation[Any]
    done: int
    total: int


class Operation(Generic[Result]):
    """One thing asked of one component; `request` says in words what, for errors and logs."""

    timeout_error: ClassVar[type[RemoteTimeout]] = RemoteTimeout
    #: Ids of the messages that it wants to see beside those of its client.
    handles: frozenset[int] = frozenset()

    def __init__(self, request: str, *, limit: float | None = None, patience: float = 10.0) -> None:
        self.request = request
        self.done = False
        self.error: MavstackError | None = None
        self.attempts = 0
        self.timeout: float | None = None
        self.parent: Operation[Any] | None = None
        self._result: Result | None = None
        self._limit = limit
        self._patience = patience
        self._last_moment: float | None = None  # of the limit
        self._quiet_until: float | None = None  # of the patience
        self._client: Client | None = None

    def result(self) -> Result:
        """The result; raises the error that it ended with."""
        if self.error is not None:
            raise self.error
        if not self.done:
            raise MavstackError(f"{self.request} has not ended yet")
        return self._result  # type: ignore[return-value]

    @property
    def client(self) -> Client:
        """The client that runs it."""
        if self._client is None:
            raise MavstackError(f"{self.request} was not begun: give it to its client's `begin`")
        return self._client

    @property
    def target(self) -> Address:
        """Of whom it is asked."""
        return self.client.target

    # What an operation overrides

    @abstractmethod
    def start(self, now: float) -> None:
        """Send the first message and set the first timer."""

    def receive(self, packet: Packet, now: float) -> None:
        """Take a packet from the target."""

    def handle_timeout(self, now: float) -> None:
        """The time in `self.timeout` has come; it was set back to None."""

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        """What a long transfer sends, one message at a time while there is room."""
        return iter(())

    def clean_up(self, now: float) -> None:
        """Tell the other end that nothing more is wanted, on cancelling and on timeouts."""

    def child_ended(self, child: Operation[Any], now: float) -> None:
        """An operation that this one began has ended."""

    # What an operation calls

    def send(self, message: Message, priority: Priority = Priority.CONTROL) -> None:
        """Send a message to the target."""
        self.client.send(message, self.target, priority)

    def finish(self, result: Result) -> None:
        """End well."""
        if not self.done:
            self.done, self._result, self.timeout = True, result, None

    def fail(self, error: MavstackError) -> None:
        """End with an error."""
        if not self.done:
            self.done, self.error, self.timeout = True, error, None

    def moved(self, now: float, done: int = 0, total: int = 0) -> None:
        """Say that the other end is alive: patience starts anew, and progress is told if it is given.

        A part of another operation says it for the whole.
        """
        self._quiet_until = now + self._patience
        if self.parent is not None:
            self.parent.moved(now, done, total)
        elif done or total:
            self.client.tell(Progress(self, done, total))

    def begin(self, child: AnyOperation, now: float) -> AnyOperation:
        """Begin another operation as a part of this one."""
        child.parent = self
        return self.client.begin(child, now)

    # What a client calls

    def attach(self, client: Client, now: float) -> None:
        """Belong to a client; the limit counts from here."""
        self._client = client
        self._last_moment = None if self._limit is None else now + self._limit

    def launch(self, now: float) -> None:
        """Start; patience counts from here."""
        self._quiet_until = now + self._patience
        self.start(now)

    @property
    def deadline(self) -> float | None:
        """When it fails if nothing moves."""
        return earliest(self._last_moment, self._quiet_until)

    def next_timeout(self) -> float | None:
        """When `tick` has something to do."""
        return earliest(self.timeout, self.deadline)

    def tick(self, now: float) -> None:
        """Let timers fire that are due."""
        if self.deadline is not None and now >= self.deadline:
            self.give_up(now)
        elif self.timeout is not None and now >= self.timeout:
            self.timeout = None
            self.handle_timeout(now)

    def give_up(self, now: float, answer: str = "no answer") -> None:
        """Fail with `timeout_error`, leaving the other end clean."""
        if not self.done:
            self._leave_clean(now)
            self.fail(
                self.timeout_error(self.request, str(self.target), attempts=self.attempts, answer=answer)
            )

    def cancel(self, now: float, answer: str = "cancelled by this side") -> None:
        """Stop, leaving the other end clean."""
        if not self.done:
            self._leave_clean(now)
            self.fail(RemoteCancelled(self.request, str(self.target), attempts=self.attempts, answer=answer))

    def _leave_clean(self, now: float) -> None:
        if self._quiet_until is not None:  # else it only waited, and the other end knows nothing of it
            self.clean_up(now)


class Client(Service):
    """The asking side of a service toward one target; a target component 0 stands for any of the system."""

    def __init__(self, local: Address, target: Address) -> None:
        super().__init__(local)
        self.target = self.hears = target
        self._own_handles = self.handles
        self._running: list[Operation[Any]] = []
        self._waiting: deque[Operation[Any]] = deque()

    @property
    def busy(self) -> bool:
        """Whether any operation has not ended."""
        return bool(self._running or self._waiting)

    def begin(self, operation: AnyOperation, now: float) -> AnyOperation:
        """Start an operation, or queue it behind those that it conflicts with."""
        operation.attach(self, now)
        self._waiting.append(operation)
        self._settle(now)
        return operation

    def cancel(self, operation: Operation[Any], now: float) -> None:
        """Stop an operation; it ends with `RemoteCancelled`."""
        operation.cancel(now)
        for child in self._parts_of(operation):
            child.cancel(now)
        self._settle(now)

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        """Whether `new` must wait until `running` has ended; the usual answer is no."""
        return False

    def notice(self, packet: Packet, now: float) -> None:
        """Take a packet of the target that may belong to no operation."""

    def receive(self, packet: Packet, now: float) -> None:
        if not self.target.covers(Address(packet.system, packet.component)):
            return
        self.notice(packet, now)
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

    def next_timeout(self) -> float | None:
        times = [operation.next_timeout() for operation in self._running]
        times += [operation.deadline for operation in self._waiting]
        return earliest(*times)

    def handle_timeout(self, now: float) -> None:
        for operation in (*self._running, *self._waiting):
            if not operation.done:
                operation.tick(now)
        self._settle(now)

    def _settle(self, now: float) -> None:
        """Report what has ended and start what may start, until nothing changes."""
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
                self.tell(OperationEnded(operation))
            else:
                operation.parent.child_ended(operation, now)
            for child in self._parts_of(operation):
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

    def _parts_of(self, operation: Operation[Any]) -> list[Operation[Any]]:
        return [
            child
            for child in (*self._running, *self._waiting)
            if child.parent is operation and not child.done
        ]


class Procedure(Operation[Result]):
    """An operation of several steps: `steps` yields operations and gets what they ended with."""

    def __init__(self, request: str, *, limit: float | None = None, patience: float = 600.0) -> None:
        super().__init__(request, limit=limit, patience=patience)
        self._story: Generator[Operation[Any], Any, Result] | None = None
        self._now = 0.0

    @abstractmethod
    def steps(self) -> Generator[Operation[Any], Any, Result]:
        """The story: `answer = yield SomeOperation(…)`; what it returns is the result."""

    @property
    def now(self) -> float:
        """The time of the step under way."""
        return self._now

    def start(self, now: float) -> None:
        self._story = story = self.steps()
        self._advance(lambda: next(story), now)

    def child_ended(self, child: Operation[Any], now: float) -> None:
        story = self._story
        if story is None or self.done:
            return
        self.attempts = max(self.attempts, child.attempts)
        self.moved(now)
        error = child.error
        if error is not None:
            self._advance(lambda: story.throw(error), now)
        else:
            self._advance(lambda: story.send(child.result()), now)

    def clean_up(self, now: float) -> None:
        if self._story is not None:
            self._story.close()

    def _advance(self, step: Callable[[], Operation[Any]], now: float) -> None:
        self._now = now
        try:
            child = step()
        except StopIteration as end:
            self.finish(end.value)
        except RemoteError as error:
            self.fail(error)
        else:
            self.begin(child, now)


class Pause(Operation[None]):
    """Wait for so many seconds, as a step of a procedure."""

    def __init__(self, seconds: float) -> None:
        super().__init__("a pause", patience=seconds + 1)
        self._seconds = seconds

    def start(self, now: float) -> None:
        self.timeout = now + self._seconds

    def handle_timeout(self, now: float) -> None:
        self.finish(None)
