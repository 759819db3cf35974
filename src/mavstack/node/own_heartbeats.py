"""The heartbeats that a node sent: a received copy is an echo over looped links, not another sender."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from mavstack.wire import Packet

if TYPE_CHECKING:
    from mavstack._core import HasCoreDialect

#: Seconds for which the node's sent heartbeats are kept, and maximum number of them.
ECHO_TIMEOUT = 10.0
MAX_HEARTBEATS = 256


class OwnHeartbeats:
    """The heartbeats of the last seconds."""

    def __init__(self, dialect: HasCoreDialect) -> None:
        self._dialect = dialect
        self._sent: deque[tuple[float, int, bytes]] = deque(maxlen=MAX_HEARTBEATS)

    def record(self, heartbeat: bytes, now: float) -> None:
        """Record the bytes of a sent heartbeat."""
        while self._sent and now - self._sent[0][0] > ECHO_TIMEOUT:
            self._sent.popleft()
        packet = Packet(heartbeat, self._dialect)
        self._sent.append((now, packet.sequence, packet.payload))

    def is_echo(self, packet: Packet) -> bool:
        """Return whether a packet with the local address is one of them."""
        return any(own[1:] == (packet.sequence, packet.payload) for own in self._sent)
