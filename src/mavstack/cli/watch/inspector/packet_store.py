"""The last packets of all streams, each with its time; the oldest are dropped first.

One limit holds for all streams together: a link with 50 packets per second is remembered for half an hour, a
flood for some seconds. Messages are decoded only when they are shown.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.wire import Packet

#: Maximum number of packets that are kept of all streams together; they take about 30 MB.
MAX_PACKETS: Final = 100_000


class StreamKey(NamedTuple):
    """One message of one component on one link: the letter of the link is empty if there is only one."""

    label: str
    system: int
    component: int
    message_id: int

    @property
    def source(self) -> str:
        """System and component: `1/1`, after the letter of the link if there are several: `A 1/1`."""
        return f"{self.label} {self.system}/{self.component}".lstrip()


class StoredPacket(NamedTuple):
    """A packet, its number since the start, its stream, and its Unix time in seconds."""

    number: int
    stream: StreamKey
    time: float
    packet: Packet


class PacketStore:
    """The last packets of all streams.

    Args:
        maximum: Packets that are kept.
    """

    def __init__(self, maximum: int = MAX_PACKETS) -> None:
        self._maximum = maximum
        self._all: deque[StoredPacket] = deque()
        self._streams: dict[StreamKey, deque[StoredPacket]] = {}
        self._count = 0

    def add(self, label: str, packets: Sequence[Packet], time: float) -> None:
        """Keep packets of a link, received at the Unix time `time`."""
        for packet in packets:
            key = StreamKey(label, packet.system, packet.component, packet.message_id)
            self._count += 1
            entry = StoredPacket(self._count, key, time, packet)
            self._all.append(entry)
            stream = self._streams.get(key)
            if stream is None:
                stream = self._streams[key] = deque()
            stream.append(entry)
        while len(self._all) > self._maximum:
            self._drop_oldest()

    def stream(self, key: StreamKey) -> Sequence[StoredPacket]:
        """Return the kept packets of a stream, oldest first."""
        return self._streams.get(key, ())

    def newest(self, key: StreamKey | None, maximum: int) -> list[StoredPacket]:
        """Return the newest packets of a stream, None for all streams, newest first."""
        entries = reversed(self._all if key is None else self.stream(key))
        return [entry for _, entry in zip(range(maximum), entries, strict=False)]

    def since(self, key: StreamKey, number: int) -> list[StoredPacket]:
        """Return the packets of a stream that came after the one with a number, oldest first."""
        found = []
        for entry in reversed(self.stream(key)):
            if entry.number <= number:
                break
            found.append(entry)
        return found[::-1]

    def copy(self) -> PacketStore:
        """Return a store with the same packets, which stays as it is."""
        other = PacketStore(self._maximum)
        other._all = self._all.copy()
        other._streams = {key: entries.copy() for key, entries in self._streams.items()}
        other._count = self._count
        return other

    def __len__(self) -> int:
        return len(self._all)

    def __iter__(self) -> Iterator[StoredPacket]:
        return iter(self._all)

    def _drop_oldest(self) -> None:
        key = self._all.popleft().stream
        entries = self._streams[key]
        entries.popleft()
        if not entries:
            del self._streams[key]
