"""A channel is one live peer of a link: a remote UDP address, a TCP connection, an open serial port.

`write` never blocks. Bytes that the peer or the network cannot take yet are queued up to `send_queue` bytes.
A chunk that exceeds the queue is dropped as a whole, so that no packet is truncated, and counted in
`counters.dropped_out`. A sender that must not lose data awaits `drain` between writes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from time import time
from typing import TYPE_CHECKING, TypeAlias

from mavstack.errors import LinkClosedError
from mavstack.security.admission import Proof

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.security.roles import RoleFilter

Data: TypeAlias = bytes | bytearray | memoryview


@dataclass(slots=True)
class Counters:
    """Counters of a channel or a link.

    Attributes:
        bytes_in: Bytes received.
        bytes_out: Bytes sent or queued.
        chunks_in: Datagrams or stream chunks received.
        chunks_out: Chunks sent or queued.
        dropped_in: Received chunks that were dropped, because the receive queue was full or the
            sender is not a peer.
        dropped_out: Written chunks that were dropped, because the send queue was full.
    """

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


@dataclass(frozen=True, slots=True)
class Request:
    """The HTTP request with which the client of a WebSocket server came.

    Attributes:
        path: The path, such as `/mavlink`.
        query: The fields of the query string; of a repeated one the last.
        headers: The headers by their names in lower case.
        subprotocol: The subprotocol that both ends agreed on; empty: none.
    """

    path: str
    query: Mapping[str, str]
    # not in the representation: headers may contain tokens and cookies
    headers: Mapping[str, str] = field(repr=False)
    subprotocol: str = ""


class Channel(ABC):
    """One live peer of a link: `write` sends bytes; received bytes are events of the link.

    Attributes:
        name: Scheme and peer, such as `udpin 127.0.0.1:14550`.
        peer: Address of the peer as text.
        role_filter: Removes the packets that the peer's role does not allow; None: it may send everything.
        closed: True after the channel is closed by either side.
        identity: The name that the peer has proved: the subject of its certificate, or the name of its key;
            empty if it has proved none.
        request: The request with which the client of a WebSocket server came; None on all other channels.
        refresh: Called before counters or times are read; calls `note_received` if a thread of the core reads
            what the peer sends (see `native_reading`, `native_stream`).
        on_closing: Called when the channel closes.
        is_authenticated: Its packets have valid signatures, which the node of the link checks.
    """

    def __init__(self, name: str, peer: str, on_closed: Callable[[Channel, str], None]) -> None:
        self.refresh: Callable[[], None] = lambda: None
        self.on_closing: Callable[[], None] = lambda: None
        self.name = name
        self.peer = peer
        self.counters = Counters()
        self.identity = ""
        self.role_filter: RoleFilter | None = None
        self.request: Request | None = None
        self.closed = False
        self.last_received = time()
        self.last_valid = 0.0
        self.is_authenticated = False
        self._on_closed = on_closed

    @property
    def counters(self) -> Counters:
        """Counters of this channel."""
        self.refresh()
        return self._counters

    @counters.setter
    def counters(self, counters: Counters) -> None:
        self._counters = counters

    @property
    def last_received(self) -> float:
        """Unix time of the last received bytes in seconds; before any, of the opening."""
        self.refresh()
        return self._last_received

    @last_received.setter
    def last_received(self, time: float) -> None:
        self._last_received = time

    @property
    def last_valid(self) -> float:
        """Unix time of the last valid packet in seconds, set by the node of the link; 0: none yet.

        A full link closes peers without one first, to make room for new peers.
        """
        self.refresh()
        return self._last_valid

    @last_valid.setter
    def last_valid(self, time: float) -> None:
        self._last_valid = time

    def note_received(self, size: int, chunks: int, received_at: float, valid_at: float) -> None:
        """Record bytes that were received elsewhere; the times are Unix times in seconds."""
        self._counters.bytes_in += size
        self._counters.chunks_in += chunks
        self._last_received = max(self._last_received, received_at)
        self._last_valid = max(self._last_valid, valid_at)

    @property
    def host(self) -> str:
        """The host in the peer's address."""
        return self.peer.rpartition(":")[0]

    @property
    def proof(self) -> Proof:
        """The proof of the peer, by which a full link chooses the peers that it keeps."""
        if self.is_authenticated or self.identity:
            return Proof.AUTHENTICATED
        return Proof.SPEAKING if self.last_valid > 0 else Proof.SILENT

    def write(self, data: Data) -> bool:
        """Send a chunk, or queue it.

        Args:
            data: The bytes to send.

        Returns:
            True if the chunk was sent or queued, False if it was dropped because the send queue is full.

        Raises:
            LinkClosedError: The channel is closed.
        """
        if self.closed:
            raise LinkClosedError(f"{self.name} is closed")
        accepted = self.send_bytes(data)
        counters = self._counters  # without `refresh`, which is about received bytes
        if accepted:
            counters.bytes_out += len(data)
            counters.chunks_out += 1
        else:
            counters.dropped_out += 1
        return accepted

    async def drain(self) -> None:  # noqa: B027 - not every channel has a send queue
        """Wait until the send queue has room.

        Raises:
            LinkClosedError: The channel was closed meanwhile.
        """

    def close(self, reason: str = "closed by this side") -> None:
        """Close the channel; queued bytes are still sent. Idempotent.

        Args:
            reason: The reason in the `ChannelClosed` event.
        """
        if not self.closed:
            self.closed = True
            self.on_closing()
            self.close_transport()
            self._on_closed(self, reason)

    def allowed(self, data: bytes) -> bytes:
        """Return received bytes without packets that the role of the peer does not allow."""
        return data if self.role_filter is None else self.role_filter.filter(data, time())

    @abstractmethod
    def send_bytes(self, data: Data) -> bool:
        """Send or queue the whole chunk; a backend implements it, programs call `write`.

        Args:
            data: The chunk.

        Returns:
            False if there is no room for it; nothing of it is sent then.
        """

    @abstractmethod
    def close_transport(self) -> None:
        """Start closing the transport; a backend implements it, programs call `close`."""

    def __repr__(self) -> str:
        return f"<Channel {self.name}{' (closed)' if self.closed else ''}>"
