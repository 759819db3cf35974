"""Offering a shell, or a serial port, to the other side of the link (SERIAL_CONTROL).

Whoever asks for responses owns it: what the program `feed`s goes there. With EXCLUSIVE nobody else gets it
until the owner lets go by a message without RESPOND, or has been silent for `idle_timeout` seconds and
another one asks. Input that comes twice is told once.
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
    Arrivals,
    data_of,
    message,
)
from mavstack.services.service import Event, Outgoing, Priority, Service

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.service import HasRoom
    from mavstack.wire import Packet

IDLE_TIMEOUT = 30.0
#: Output that waits for room; beyond it the oldest is dropped, and counted.
MAX_WAITING = 64 * 1024
MAX_SOURCES = 32


@dataclass(frozen=True, slots=True)
class ShellOpened(Event):
    """Somebody owns the shell now; `baudrate` is 0 if it is to stay as it is."""

    owner: Address
    baudrate: int


@dataclass(frozen=True, slots=True)
class ShellInput(Event):
    """Somebody wrote; `late` bytes were overtaken by others that were told before."""

    source: Address
    data: bytes
    late: bool = False


@dataclass(frozen=True, slots=True)
class ShellClosed(Event):
    """The owner let go, or was replaced."""

    owner: Address


@dataclass(slots=True)
class _Owner:
    address: Address
    exclusive: bool
    heard_at: float


class ShellServer(Service):
    """One device of a component, offered to one owner at a time."""

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
        self._arrivals: OrderedDict[Address, Arrivals] = OrderedDict()

    @property
    def owner(self) -> Address | None:
        """Who owns it."""
        return self._owner.address if self._owner else None

    def feed(self, data: bytes) -> None:
        """Output for the owner; without one it goes nowhere."""
        if self._owner is None:
            return
        self._output += [data[at : at + DATA_SIZE] for at in range(0, len(data), DATA_SIZE)]
        self._waiting += len(data)
        while self._waiting > MAX_WAITING:
            lost = len(self._output.popleft())
            self._waiting -= lost
            self.dropped += lost

    def close(self) -> None:
        """The program ends the shell; output that still waits is not sent."""
        if self._owner is not None:
            self.emit(ShellClosed(self._owner.address))
            self._owner = None
            self._output.clear()
            self._waiting = 0

    def receive(self, packet: Packet, now: float) -> None:
        source = Address(packet.system, packet.component)
        match packet.message:
            case common.SerialControl(device=self.device, flags=flags) as serial if not flags & REPLY:
                arrivals = self._arrivals_of(source)
                if arrivals.is_copy(packet, now):
                    return
                late = arrivals.is_late(packet, now)
                if late and source != self.owner:
                    return  # of an owner that has let go since
                self._asked(source, serial, late, now)

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        owner = self.owner
        while owner is not None and self._output and has_room(owner, Priority.STREAM):
            data = self._output.popleft()
            self._waiting -= len(data)
            yield Outgoing(message(owner, self.device, REPLY, data), owner, Priority.STREAM)

    def _asked(self, source: Address, serial: common.SerialControl, late: bool, now: float) -> None:
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
        return now - owner.heard_at >= self._idle_timeout

    def _own(self, source: Address, serial: common.SerialControl, now: float) -> None:
        exclusive = bool(serial.flags & EXCLUSIVE)
        if self._owner is not None and self._owner.address == source:
            self._owner.heard_at, self._owner.exclusive = now, exclusive
            return
        self.close()
        self._owner = _Owner(source, exclusive, now)
        self.emit(ShellOpened(source, serial.baudrate))

    def _arrivals_of(self, source: Address) -> Arrivals:
        arrivals = self._arrivals.setdefault(source, Arrivals())
        self._arrivals.move_to_end(source)
        if len(self._arrivals) > MAX_SOURCES:
            self._arrivals.popitem(last=False)
        return arrivals
