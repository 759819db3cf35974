"""Requests to a flight controller, sans-IO: one in flight, with priorities, timeouts and retries.

MSP has no request numbers: a reply names only its command. One request at a time is therefore in flight, and
a request whose reply does not come in time is sent again. The reply to an earlier attempt may still come, so
before the same command is sent again the engine asks for MSP_API_VERSION: the firmware replies in order, so
that the reply to that request shows that no earlier one is under way.

Requests wait by priority. One that has waited for `MAX_WAIT` is sent next, alternating with higher
priorities, so that fast polling on a slow line does not block the reading of settings.

Bytes go to `receive`, come from `data_to_send`, and `next_due` is the time of the next `step`.
"""

from __future__ import annotations

from collections import deque
from enum import IntEnum
from functools import lru_cache
from typing import TYPE_CHECKING, Final

from mavstack.errors import (
    InvalidArgumentError,
    InvalidStateError,
    MspDenied,
    MspTimeout,
    RemoteCancelled,
    RemoteError,
)
from mavstack.msp.frame import MAX_V1_COMMAND, NO_REPLY, Direction, Frame, FrameVersion
from mavstack.msp.parser import FrameParser

if TYPE_CHECKING:
    from collections.abc import Callable

#: Seconds for one reply: a firmware handles its serial ports 100 times a second, and writing takes longer.
DEFAULT_REPLY_TIMEOUT: Final = 0.5
#: Maximum number of attempts after the first one.
DEFAULT_RETRIES: Final = 2
#: Seconds after which a waiting request is sent before requests of higher priority, except control.
MAX_WAIT: Final = 0.25
#: Maximum payload size in bytes of a v1 request; a longer one is sent as v2, since firmware accepts no jumbo
#: requests.
MAX_V1_REQUEST: Final = 254
_API_VERSION: Final = 1


class Priority(IntEnum):
    """The order of waiting requests, the first one first."""

    CONTROL = 0  # RC channels and motors
    TELEMETRY = 1  # values that are read at a high rate
    NORMAL = 2
    BACKGROUND = 3  # slow polling, and whole sets of settings


class Request:
    """A request, from its start to its reply or its typed error; made by `RequestEngine.request`.

    Attributes:
        command: Number of the command.
        payload: The bytes that are sent.
        attempts: How often it was sent.
        done: True when the request has ended.
        error: The error with which it ended, or None.
    """

    def __init__(self, frame: Frame, name: str, priority: Priority, encoded: bytes = b"") -> None:
        self.command = frame.command
        self.payload = frame.payload
        self.name = name
        self.priority = priority
        self.attempts = 0
        self.done = False
        self.error: RemoteError | None = None
        self.frame = frame
        self.encoded = encoded or frame.encode()
        self.reply_timeout = DEFAULT_REPLY_TIMEOUT
        self.retries = DEFAULT_RETRIES
        self.deadline: float | None = None
        self.callback: Callable[[Request], None] | None = None
        self.waiting_since: float | None = None
        self._reply = b""

    @property
    def expects_reply(self) -> bool:
        """False for a request of v2 that asks for no reply."""
        return not self.frame.flags & NO_REPLY

    def result(self) -> bytes:
        """Return the payload of the reply.

        Raises:
            MspTimeout: No reply came in time.
            MspDenied: The firmware refused the request.
            RemoteCancelled: The request was cancelled, or the connection was closed.
            InvalidStateError: The request has not ended.
        """
        if not self.done:
            raise InvalidStateError(f"{self.name} has not ended")
        if self.error is not None:
            raise self.error
        return self._reply

    def finish(self, reply: bytes = b"", error: RemoteError | None = None) -> None:
        """End the request, and call its callback. Idempotent."""
        if self.done:
            return
        self.done, self._reply, self.error = True, reply, error
        if self.callback is not None:
            self.callback(self)

    def __repr__(self) -> str:
        state = "waiting" if not self.done else "failed" if self.error else "answered"
        return f"<Request {self.name} ({state})>"


@lru_cache(256)
def _poll(command: int) -> tuple[Frame, bytes]:
    """Return the v1 frame of a request without payload, which is sent again and again, and its bytes."""
    frame = Frame(command)
    return frame, frame.encode()


class RequestEngine:
    """The client's side of a line to one flight controller.

    Attributes:
        target: The flight controller in error texts.
        parser: The parser of the line, with its counters.
        unsolicited: Called with each frame that answers no request, or None.
        late_replies: Replies to requests that were sent again or given up.
        latency: Seconds from the last request to its reply; None before the first one.
    """

    def __init__(self, target: str = "the flight controller") -> None:
        self.target = target
        self.parser = FrameParser()
        self.unsolicited: Callable[[Frame], None] | None = None
        self.late_replies = 0
        self.latency: float | None = None
        self._waiting: deque[Request] = deque()
        self._current: Request | None = None
        self._sent_at = self._timer = 0.0
        self._late: set[int] = set()  # commands whose reply may still arrive late
        self._barrier: Request | None = None
        self._promoted = False
        self._output = bytearray()

    @property
    def idle(self) -> bool:
        """True if no request waits or is in flight."""
        return self._current is None and not self._waiting

    @property
    def current(self) -> Request | None:
        """The request in flight."""
        return self._current

    def request(
        self,
        command: int,
        payload: bytes = b"",
        *,
        priority: Priority = Priority.NORMAL,
        timeout: float = DEFAULT_REPLY_TIMEOUT,
        retries: int = DEFAULT_RETRIES,
        version: FrameVersion | None = None,
        flags: int = 0,
        deadline: float | None = None,
        name: str = "",
        callback: Callable[[Request], None] | None = None,
    ) -> Request:
        """Add a request; the next `step` sends it when its turn comes.

        Args:
            command: Number of the command.
            payload: The bytes of the message.
            priority: Its place among the waiting requests.
            timeout: Seconds for the reply to each attempt.
            retries: Further attempts after the first one.
            version: The encoding; None: v1, or v2 if v1 cannot carry the request.
            flags: Flags of v2, such as `NO_REPLY`.
            deadline: Time at which the request fails at the latest; None: none.
            name: Official name of the command in error texts; empty: that of an enum member, or the number.
            callback: Called with the request when it has ended.

        Returns:
            The request.

        Raises:
            InvalidArgumentError: An argument is out of range, or does not fit the encoding.
        """
        if timeout <= 0 or retries < 0:
            raise InvalidArgumentError(
                f"timeout must be above 0 and retries at least 0, got {timeout}, {retries}"
            )
        needs_v2 = command > MAX_V1_COMMAND or len(payload) > MAX_V1_REQUEST or flags
        if version is None and not needs_v2 and not payload:
            frame, encoded = _poll(int(command))
        else:
            version = version or (FrameVersion.V2 if needs_v2 else FrameVersion.V1)
            frame, encoded = Frame(int(command), bytes(payload), Direction.REQUEST, version, flags), b""
        name = name or getattr(command, "name", "") or f"MSP command {command}"
        request = Request(frame, name, priority, encoded)
        request.reply_timeout, request.retries = timeout, retries
        request.deadline, request.callback = deadline, callback
        self._waiting.append(request)
        return request

    def cancel(self, request: Request) -> None:
        """End a request with `RemoteCancelled`; has no effect on one that has ended."""
        if request in self._waiting:
            self._waiting.remove(request)
        elif request is self._current:
            self._end_current(answered=False)
        request.finish(error=self._error(RemoteCancelled, request, "cancelled"))

    def cancel_all(self, reason: str) -> None:
        """End all requests with `RemoteCancelled`, because the connection is closed or lost.

        Args:
            reason: The reason in the text of the errors.
        """
        requests = [*([self._current] if self._current else []), *self._waiting]
        self._waiting.clear()
        self._current = None
        self._late.clear()
        self._output.clear()
        for request in requests:
            request.finish(error=self._error(RemoteCancelled, request, reason))

    def receive(self, data: bytes | bytearray | memoryview, now: float) -> None:
        """Process bytes of the flight controller, and send the next request."""
        for frame in self.parser.feed(data):
            self._receive_frame(frame, now)
        self.step(now)

    def step(self, now: float) -> None:
        """Do what is due: repeat or fail requests, and send the next one."""
        if self._waiting:
            self._expire(now)
        if self._current is not None and now >= self._timer:
            self._handle_timeout(self._current, now)
        while self._current is None and self._waiting:
            self._send_next(now)

    def data_to_send(self) -> bytes:
        """Return the bytes for the flight controller, once."""
        if not self._output:
            return b""
        data = bytes(self._output)
        self._output.clear()
        return data

    def next_due(self) -> float | None:
        """Return the time of the next `step`, or None; call it after `step`."""
        current = None if self._current is None else self._timer
        if not self._waiting:
            return current
        times = [request.deadline for request in self._waiting if request.deadline is not None]
        return min(times if current is None else [current, *times], default=None)

    def _receive_frame(self, frame: Frame, now: float) -> None:
        current = self._current
        if frame.direction is Direction.REQUEST or current is None or frame.command != current.command:
            self._receive_unexpected(frame)
            return
        self.latency = now - self._sent_at
        self._end_current(answered=True)
        if frame.direction is Direction.ERROR:
            error = self._error(MspDenied, current, "refused by the firmware")
            current.finish(frame.payload, error)
        else:
            current.finish(frame.payload)

    def _receive_unexpected(self, frame: Frame) -> None:
        if frame.command in self._late and frame.direction is not Direction.REQUEST:
            self.late_replies += 1
        elif self.unsolicited is not None:
            self.unsolicited(frame)

    def _end_current(self, *, answered: bool) -> None:
        """Take the request out of flight, and remember whether further replies to it may come."""
        current, self._current = self._current, None
        if current is None:
            return
        if answered or current is self._barrier:
            self._late.clear()  # replies to earlier requests came before this reply
        if current.attempts > answered:
            self._late.add(current.command)

    def _expire(self, now: float) -> None:
        for request in [each for each in self._waiting if each.deadline is not None and now >= each.deadline]:
            self._waiting.remove(request)
            answer = "no answer" if request.attempts else "the line was busy with other requests"
            request.finish(error=self._error(MspTimeout, request, answer))

    def _handle_timeout(self, current: Request, now: float) -> None:
        for frame in self.parser.resynchronize():
            self._receive_frame(frame, now)
        if self._current is not current:
            return
        expired = current.deadline is not None and now >= current.deadline
        if current.attempts <= current.retries and not expired:
            self._send(current, now)
            return
        self._end_current(answered=False)
        current.finish(error=self._error(MspTimeout, current, "no answer"))

    def _send_next(self, now: float) -> None:
        request = self._choose(now)
        if request.command in self._late and request.command != _API_VERSION:
            self._barrier = Request(Frame(_API_VERSION), "MSP_API_VERSION", Priority.CONTROL)
            self._barrier.retries, self._barrier.deadline = 0, request.deadline
            self._send(self._barrier, now)
            return
        self._waiting.remove(request)
        self._send(request, now)
        if not request.expects_reply:
            self._current = None
            request.finish()

    def _choose(self, now: float) -> Request:
        """Return the request that is sent next."""
        for request in self._waiting:
            if request.waiting_since is None:
                request.waiting_since = now
        if len(self._waiting) == 1:
            self._promoted = False
            return self._waiting[0]
        # `min` returns the oldest request of the highest priority.
        first = min(self._waiting, key=lambda request: request.priority)
        if first.priority is Priority.CONTROL or self._promoted:
            self._promoted = False
            return first
        oldest = min(self._waiting, key=lambda request: request.waiting_since or 0.0)
        self._promoted = oldest is not first and now - (oldest.waiting_since or 0.0) > MAX_WAIT
        return oldest if self._promoted else first

    def _send(self, request: Request, now: float) -> None:
        request.attempts += 1
        self._current = request
        self._sent_at = now
        self._timer = now + request.reply_timeout
        if request.deadline is not None:
            self._timer = min(self._timer, request.deadline)
        self._output += request.encoded

    def _error(self, kind: type[RemoteError], request: Request, answer: str) -> RemoteError:
        return kind(f"{request.name} on", self.target, attempts=max(request.attempts, 1), answer=answer)
