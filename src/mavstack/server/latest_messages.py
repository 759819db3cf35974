"""The latest packet of each message from each component, with its count and rate."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.wire import Packet

#: Maximum number of messages of all components together; the oldest received ones are dropped.
MAX_MESSAGES: Final = 8192
#: Weight of the newest interval in the moving average of the intervals.
_WEIGHT: Final = 0.2
#: Number of average intervals without a new packet after which a message has no rate.
_MISSED_INTERVALS: Final = 5.0


class LatestMessage:
    """The latest packet of one message from one component."""

    __slots__ = ("count", "interval", "packet", "text", "time")

    def __init__(self, packet: Packet, time: float) -> None:
        self.packet = packet
        #: The time of receipt, in Unix seconds.
        self.time = time
        self.count = 1
        #: The average interval in seconds; 0 before the second packet.
        self.interval = 0.0
        #: The packet as JSON, after the first request for it; empty before.
        self.text = ""

    def update(self, packet: Packet, time: float) -> None:
        """Store the next packet."""
        interval = max(time - self.time, 0.0)
        self.interval += (interval - self.interval) * _WEIGHT if self.count > 1 else interval
        self.packet, self.time, self.text = packet, time, ""
        self.count += 1

    def rate(self, now: float) -> float:
        """Return the rate in hertz; 0 if the message is not received any more."""
        is_current = now - self.time <= max(_MISSED_INTERVALS * self.interval, 1.0)
        return 1.0 / self.interval if self.interval > 0.0 and is_current else 0.0


class LatestMessages:
    """The latest packets of all components."""

    def __init__(self) -> None:
        self._latest: dict[tuple[int, int, int], LatestMessage] = {}
        #: The latest message of each system and message id, of any component.
        self._newest: dict[tuple[int, int], LatestMessage] = {}

    def store(self, packet: Packet, time: float) -> None:
        """Store a received packet."""
        key = (packet.system, packet.component, packet.message_id)
        known = self._latest.get(key)
        if known is None:
            known = self._latest[key] = LatestMessage(packet, time)
            self._drop_old()
        else:
            known.update(packet, time)
        self._newest[key[0], key[2]] = known

    def _drop_old(self) -> None:
        if len(self._latest) > MAX_MESSAGES:
            newest = sorted(self._latest.items(), key=lambda item: item[1].time, reverse=True)
            self._latest = dict(newest[: MAX_MESSAGES // 2])
            self._newest = {(key[0], key[2]): each for key, each in reversed(self._latest.items())}

    def of_system(self, system: int) -> Iterator[LatestMessage]:
        """Yield the latest message of each kind from each component of a system."""
        return (each for key, each in list(self._latest.items()) if key[0] == system)

    def find(self, system: int, message_id: int, component: int | None = None) -> LatestMessage | None:
        """Return the latest message of an id; from several components the one received last."""
        if component is None:
            return self._newest.get((system, message_id))
        return self._latest.get((system, component, message_id))
