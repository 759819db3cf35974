"""A channel is one live peer of a link: a remote UDP address, a TCP connection, an open serial port.

`write` never waits. What the peer or the network cannot take yet is queued up to a bound (`send_queue`
bytes); a chunk over the bound is dropped whole, so that no packet is ever cut in two, and counted in
`counters.dropped_out`. Who must not lose anything calls `drain` between writes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from mavstack.errors import LinkClosedError

if TYPE_CHECKING:
    from collections.abc import Callable

Data: TypeAlias = bytes | bytearray | memoryview


@dataclass(slots=True)
class Counters:
    """What went through a channel, in bytes and in chunks, and the chunks that were dropped."""

    bytes_in: int = 0
    bytes_out: int = 0
    chunks_in: int = 0
    chunks_out: int = 0
    dropped_in: int = 0
    dropped_out: int = 0

    def __add__(self, other: Counters) -> Counters:
        return Counters(
            self.bytes_in + other.bytes_in,
            self.bytes_out + other.bytes_out,
            self.chunks_in + other.chunks_in,
            self.chunks_out + other.chunks_out,
            self.dropped_in + other.dropped_in,
            self.dropped_out + other.dropped_out,
        )


class Channel(ABC):
    """One live peer: bytes out by `write`, bytes in by the link's events."""

    def __init__(self, name: str, peer: str, gone: Callable[[Channel, str], None]) -> None:
        self.name = name
        self.peer = peer
        self.counters = Counters()
        self.closed = False
        self._gone = gone

    def write(self, data: Data) -> bool:
        """Send, or queue for sending; False if there was no room and the chunk was dropped."""
        if self.closed:
            raise LinkClosedError(f"{self.name} is closed")
        accepted = self._send(data)
        if accepted:
            self.counters.bytes_out += len(data)
            self.counters.chunks_out += 1
        else:
            self.counters.dropped_out += 1
        return accepted

    async def drain(self) -> None:  # noqa: B027 - a channel without a queue of its own has nothing to wait for
        """Wait until there is room for more."""

    def close(self, reason: str = "closed by this side") -> None:
        """Hang up; what is queued is still sent. Closing twice does nothing."""
        if not self.closed:
            self.closed = True
            self._shut()
            self._gone(self, reason)

    @abstractmethod
    def _send(self, data: Data) -> bool:
        """Take the chunk whole, or refuse it."""

    @abstractmethod
    def _shut(self) -> None:
        """Start closing what is underneath."""

    def __repr__(self) -> str:
        return f"<Channel {self.name}{' (closed)' if self.closed else ''}>"
