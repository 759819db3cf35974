"""The client of a shell or a serial port of a remote component (SERIAL_CONTROL; PX4's nsh).

An empty message with RESPOND opens it, and is repeated until an answer arrives; a message without RESPOND
closes it, and is sent several times, since nothing is acknowledged: PX4 then ends its shell, ArduPilot
unlocks its port. Pending output is sent before it closes.

Written data is split behind the end of a line where possible, so that a line of up to 70 bytes is one message
and arrives completely or not at all. ArduPilot sends a port's bytes only on request: for it `poll` is the
interval of requests; PX4 sends its shell's output by itself.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.serial_control.messages import (
    DATA_SIZE,
    EXCLUSIVE,
    MULTI,
    REPLY,
    RESPOND,
    SHELL,
    ArrivalTracker,
    data_of,
    message,
)
from mavstack.services.service import Event, Outgoing, Priority, Service

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.service import HasRoom
    from mavstack.wire import Packet

OPEN_ATTEMPTS = 5
OPEN_INTERVAL = 1.0
CLOSE_REPETITIONS = 3
CLOSE_INTERVAL = 0.2
#: The largest number of messages that wait to be sent.
MAX_PENDING = 4096


@dataclass(frozen=True, slots=True)
class ShellOutput(Event):
    """Output of the shell; `late` if it arrived after newer output."""

    data: bytes
    late: bool = False


@dataclass(frozen=True, slots=True)
class ShellReleased(Event):
    """The shell was closed by this client, and the close was sent."""


class ShellClient(Service):
    """A shell or a serial port of one component.

    Args:
        local: The local component.
        target: The remote component.
        device: The SERIAL_CONTROL_DEV.
        baudrate: The baud rate of a port; 0 leaves it unchanged.
        exclusive: Ask for exclusive use.
        poll: Seconds between two requests for output; None if the component sends it by itself.
    """

    handles = message_ids(common.SerialControl)

    def __init__(
        self,
        local: Address,
        target: Address,
        device: int = SHELL,
        *,
        baudrate: int = 0,
        exclusive: bool = True,
        poll: float | None = None,
    ) -> None:
        super().__init__(local)
        self.target = self.source_filter = target
        self.device = int(device)
        self._baudrate = baudrate
        self._flags = RESPOND | MULTI | (EXCLUSIVE if exclusive else 0)
        self._poll = poll
        self._is_open = False
        self._open_attempts_left = self._closes_left = 0
        self._due: float | None = None
        self._waiting: deque[bytes] = deque()
        self._arrivals = ArrivalTracker()

    @property
    def is_open(self) -> bool:
        """True if it can be written to."""
        return self._is_open

    @property
    def waiting(self) -> int:
        """The number of bytes that wait to be sent."""
        return sum(map(len, self._waiting))

    def open(self, now: float) -> None:
        """Open the shell; its prompt is the first output."""
        self._is_open = True
        self._closes_left = 0
        self._open_attempts_left = OPEN_ATTEMPTS
        self._due = now
        self.handle_timeout(now)

    def write(self, data: bytes, now: float) -> None:
        """Write bytes; opens the shell if it is not open.

        Raises:
            InvalidArgumentError: Too much data waits to be sent.
        """
        if not self._is_open:
            self.open(now)
        chunks = list(_chunks(data))
        if len(self._waiting) + len(chunks) > MAX_PENDING:
            raise InvalidArgumentError(f"at most {MAX_PENDING * DATA_SIZE} bytes can wait to be sent")
        self._waiting += chunks

    def write_line(self, text: str, now: float) -> None:
        """Write a line of text."""
        self.write(text.encode() + b"\n", now)

    def close(self, now: float) -> None:
        """Close the shell, after the written data is sent."""
        if self._is_open:
            self._is_open = False
            self._closes_left = CLOSE_REPETITIONS
            self._due = now

    def receive(self, packet: Packet, now: float) -> None:
        if not self.target.covers(Address(packet.system, packet.component)):
            return
        match packet.message:
            case common.SerialControl(device=device, flags=flags) as serial:
                data = data_of(serial)
                if device != self.device or not flags & REPLY or not (self._is_open or self._closes_left):
                    return
                self._open_attempts_left = 0
                if data and not self._arrivals.is_copy(packet, now):
                    self.emit(ShellOutput(data, self._arrivals.is_late(packet, now)))

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        while self._waiting and has_room(self.target, Priority.STREAM):
            yield Outgoing(self._message(self._flags, self._waiting.popleft()), self.target, Priority.STREAM)
        if not self._waiting and self._closes(now):
            yield Outgoing(self._message(0), self.target)
            self._closes_left -= 1
            self._due = now + CLOSE_INTERVAL if self._closes_left else None
            if not self._closes_left:
                self.emit(ShellReleased())

    def next_timeout(self) -> float | None:
        # Pending data is sent before the close, and it waits for room on the link, so that no time is due.
        return None if self._closes_left and self._waiting else self._due

    def handle_timeout(self, now: float) -> None:
        if not self._is_open or self._due is None or now < self._due:
            return
        if self._open_attempts_left:
            self._open_attempts_left -= 1
            self.send(self._message(self._flags), self.target)
        elif self._poll is not None and not self._waiting:
            self.send(self._message(self._flags), self.target)
        self._due = self._next_due(now)

    def _next_due(self, now: float) -> float | None:
        if self._open_attempts_left:
            return now + OPEN_INTERVAL
        return None if self._poll is None else now + self._poll

    def _closes(self, now: float) -> bool:
        return bool(self._closes_left) and self._due is not None and now >= self._due

    def _message(self, flags: int, data: bytes = b"") -> common.SerialControl:
        return message(self.target, self.device, flags, data, baudrate=self._baudrate)


def _chunks(data: bytes) -> Iterator[bytes]:
    while data:
        end = data.rfind(b"\n", 0, DATA_SIZE) + 1 or DATA_SIZE
        yield data[:end]
        data = data[end:]
