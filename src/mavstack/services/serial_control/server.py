"""The server of a shell or a serial port (SERIAL_CONTROL).

A client that requests responses owns the device: the program's output (`feed`) goes to it. With EXCLUSIVE no
other client gets the device until the owner releases it by a message without RESPOND, or has been silent for
`idle_timeout` seconds and another client asks. Duplicate input is ignored.
"""

from __future__ import annotations

from collections import OrderedDict, deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.serial_control.messages import (
    DATA_SIZE,
    EXCLUSIVE,
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

IDLE_TIMEOUT = 30.0
#: The largest number of bytes that wait for room on the link; beyond it the oldest are dropped and counted.
MAX_PENDING = 64 * 1024
MAX_SOURCES = 32


@dataclass(frozen=True, slots=True)
class ShellOpened(Event):
    """A client owns the device now; `baudrate` is 0 if it shall not change."""

    owner: Address
    baudrate: int


@dataclass(frozen=True, slots=True)
class ShellInput(Event):
    """Input from a client; `late` if it arrived after newer input."""

    source: Address
    data: bytes
    late: bool = False


@dataclass(frozen=True, slots=True)
class ShellClosed(Event):
    """The owner released the device, or was replaced."""

    owner: Address


@dataclass(slots=True)
class _Owner:
    address: Address
    exclusive: bool
    received_at: float


class ShellServer(Service):
    """The server of one device, which has one owner at a time."""

    handles = message_ids(common.SerialControl)

    def __init__(self, local: Address, device: int = SHELL, *, idle_timeout: float = IDLE_TIMEOUT) -> None:
        super().__init__(local)
        self.device = int(device)
        self.refused = 0
        self.dropped = 0
        self._idle_timeout = idle_timeout
        self._owner: _Owner | None = None
        self._output: deque[bytes] = deque()
        self._waiting = 0
        self._arrivals: OrderedDict[Address, ArrivalTracker] = OrderedDict()

    @property
    def owner(self) -> Address | None:
        """The client that owns the device, or None."""
        return self._owner.address if self._owner else None

    def feed(self, data: bytes) -> None:
        """Send output to the owner; without an owner it is discarded."""
        if self._owner is None:
            return
        self._output += [data[at : at + DATA_SIZE] for at in range(0, len(data), DATA_SIZE)]
        self._waiting += len(data)
        while self._waiting > MAX_PENDING:
            lost = len(self._output.popleft())
            self._waiting -= lost
            self.dropped += lost

    def close(self) -> None:
        """Close the device on behalf of the program; pending output is discarded."""
        if self._owner is not None:
            self.emit(ShellClosed(self._owner.address))
            self._owner = None
            self._output.clear()
            self._waiting = 0

    def receive(self, packet: Packet, now: float) -> None:
        source = Address(packet.system, packet.component)
        match packet.message:
            case common.SerialControl(device=self.device, flags=flags) as serial if not flags & REPLY:
                arrivals = self._tracker_of(source)
                if arrivals.is_copy(packet, now):
                    return
                late = arrivals.is_late(packet, now)
                if late and source != self.owner:
                    return  # a late packet of an owner that has released the port since
                self._handle(source, serial, late, now)

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        owner = self.owner
        while owner is not None and self._output and has_room(owner, Priority.STREAM):
            data = self._output.popleft()
            self._waiting -= len(data)
            yield Outgoing(message(owner, self.device, REPLY, data), owner, Priority.STREAM)

    def _handle(self, source: Address, serial: common.SerialControl, late: bool, now: float) -> None:
        data = data_of(serial)
        responds = bool(serial.flags & RESPOND) or late
        if not self._may_use(source, now):
            self.refused += 1
            return
        if responds:
            self._own(source, serial, now)
        if data:
            self.emit(ShellInput(source, data, late))
        if not responds and source == self.owner:
            self.close()

    def _may_use(self, source: Address, now: float) -> bool:
        owner = self._owner
        if owner is None or owner.address == source or not owner.exclusive:
            return True
        return now - owner.received_at >= self._idle_timeout

    def _own(self, source: Address, serial: common.SerialControl, now: float) -> None:
        exclusive = bool(serial.flags & EXCLUSIVE)
        if self._owner is not None and self._owner.address == source:
            self._owner.received_at, self._owner.exclusive = now, exclusive
            return
        self.close()
        self._owner = _Owner(source, exclusive, now)
        self.emit(ShellOpened(source, serial.baudrate))

    def _tracker_of(self, source: Address) -> ArrivalTracker:
        arrivals = self._arrivals.setdefault(source, ArrivalTracker())
        self._arrivals.move_to_end(source)
        if len(self._arrivals) > MAX_SOURCES:
            self._arrivals.popitem(last=False)
        return arrivals
