"""The ground station's side of corrections: it sends the frames of a source once over each link.

Corrections are useless when late, so nothing is queued behind a slow link: the frames of an epoch replace
those of the epoch before that are still waiting, and what waited for two seconds is dropped. Over a channel
whose bandwidth is known, fragments are spread over the epoch and take at most half of it: a command waits
for one fragment at most. Frames that describe the station are repeated at most every ten seconds.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.gnss.rtcm import STATION_NUMBERS, RtcmFramer
from mavstack.services.addressing import BROADCAST
from mavstack.services.rtk.fragments import MAX_FRAME, fragment
from mavstack.services.service import HasRoom, Outgoing, Priority, Service, always_room, earliest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.dialects import common
    from mavstack.gnss.rtcm import RtcmFrame
    from mavstack.services.addressing import Address

#: Seconds after which a waiting frame is dropped.
MAX_AGE: Final = 2.0
#: Seconds between two frames with the same message number, if that message describes the base station.
STATION_INTERVAL: Final = 10.0
#: The share of a known bandwidth that corrections may use.
BANDWIDTH_SHARE: Final = 0.5
#: Bytes of a packet in addition to its fragment: header, checksum, flags and length.
_OVERHEAD: Final = 14
#: The largest number of frames that wait for one channel: each of four constellations has one frame, and the
#: station has some.
_MAX_WAITING: Final = 32


class ChannelPace(NamedTuple):
    """An open channel: its name, and its bandwidth in bytes per second, or None if it is not known."""

    name: str
    bandwidth: float | None


@dataclass(slots=True)
class CorrectionCounts:
    """Counts of the frames of corrections.

    Attributes:
        frames: Frames received from the source.
        data: Their bytes.
        sent: Frames sent, on each channel.
        too_long: Frames of more than 720 bytes, which cannot be sent.
        late: Frames replaced by newer ones, or dropped, because a channel was too slow.
        thinned: Frames about the station that were repeated too soon.
        bad_bytes: Bytes of the source outside of frames.
        numbers: Frames by message number.
        last: The time of the last frame, Unix seconds; None before the first.
    """

    frames: int = 0
    data: int = 0
    sent: int = 0
    too_long: int = 0
    late: int = 0
    thinned: int = 0
    bad_bytes: int = 0
    numbers: dict[int, int] = field(default_factory=dict)
    last: float | None = None


class _Waiting(NamedTuple):
    frame: RtcmFrame
    messages: deque[common.GpsRtcmData]
    since: float


class _Channel:
    """The frames that wait for one channel."""

    def __init__(self) -> None:
        self.waiting: deque[_Waiting] = deque()
        self.due = 0.0
        #: True while the sender waits for room on the link, not for a time.
        self.is_blocked = False

    def add(self, entry: _Waiting) -> int:
        """Queue a frame; return the number of older frames that it replaces."""
        before = len(self.waiting)
        self.waiting = deque(kept for kept in self.waiting if not _replaces(entry, kept))
        self.waiting.append(entry)
        if len(self.waiting) > _MAX_WAITING:
            self.waiting.popleft()
        return before + 1 - len(self.waiting)

    def drop_late(self, now: float) -> int:
        before = len(self.waiting)
        self.waiting = deque(entry for entry in self.waiting if now - entry.since < MAX_AGE)
        return before - len(self.waiting)


class CorrectionSender(Service):
    """Sends RTCM frames as GPS_RTCM_DATA to all vehicles.

    Args:
        local: The address of the ground station.
        channels: Returns the open channels.
    """

    def __init__(self, local: Address, channels: Callable[[], Sequence[ChannelPace]]) -> None:
        super().__init__(local)
        self._channels = channels
        self._framer = RtcmFramer()
        self._sequence = 0
        self._queues: dict[str, _Channel] = {}
        self._station_sent: dict[int, tuple[float, bytes]] = {}
        self.counts = CorrectionCounts()

    def feed(self, data: bytes, now: float) -> list[RtcmFrame]:
        """Send the frames that bytes of the source complete.

        Args:
            data: Bytes of the source, cut anywhere.
            now: Unix seconds.

        Returns:
            The frames.
        """
        frames = self._framer.feed(data)
        self.counts.bad_bytes = self._framer.bad_bytes
        for frame in frames:
            self._count(frame, now)
            if self._is_wanted(frame, now):
                self._queue(frame, now)
        return frames

    def reset(self) -> None:
        """Drop an incomplete frame of the source, after its connection was lost."""
        self._framer.reset()

    def _count(self, frame: RtcmFrame, now: float) -> None:
        counts = self.counts
        counts.frames += 1
        counts.data += len(frame.data)
        counts.numbers[frame.number] = counts.numbers.get(frame.number, 0) + 1
        counts.last = now

    def _is_wanted(self, frame: RtcmFrame, now: float) -> bool:
        if len(frame.data) > MAX_FRAME:
            self.counts.too_long += 1
            return False
        if frame.number not in STATION_NUMBERS:
            return True
        sent_at, data = self._station_sent.get(frame.number, (-STATION_INTERVAL, b""))
        if data == frame.data and now - sent_at < STATION_INTERVAL:
            self.counts.thinned += 1
            return False
        self._station_sent[frame.number] = now, frame.data
        return True

    def _queue(self, frame: RtcmFrame, now: float) -> None:
        messages = fragment(frame.data, self._sequence)
        self._sequence += 1
        names = [pace.name for pace in self._channels()]
        self._queues = {name: self._queues.get(name) or _Channel() for name in names}
        for queue in self._queues.values():
            self.counts.late += queue.add(_Waiting(frame, deque(messages), now))

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        for pace in self._channels():
            queue = self._queues.get(pace.name)
            if queue is not None:
                self.counts.late += queue.drop_late(now)
                yield from self._fragments(pace, queue, now, has_room)

    def _fragments(
        self, pace: ChannelPace, queue: _Channel, now: float, has_room: HasRoom
    ) -> Iterator[Outgoing]:
        while queue.waiting and now >= queue.due:
            queue.is_blocked = not has_room(BROADCAST, Priority.STREAM, pace.name)
            if queue.is_blocked:
                return
            messages = queue.waiting[0].messages
            message = messages.popleft()
            if not messages:
                queue.waiting.popleft()
                self.counts.sent += 1
            if pace.bandwidth is not None:
                size = message.len + _OVERHEAD
                queue.due = now + size / (pace.bandwidth * BANDWIDTH_SHARE)
            yield Outgoing(message, BROADCAST, Priority.STREAM, pace.name)

    def next_timeout(self) -> float | None:
        queues = self._queues.values()
        return earliest(*(queue.due for queue in queues if queue.waiting and not queue.is_blocked))

    def handle_timeout(self, now: float) -> None:
        """Forget closed channels; `bulk_messages` sends the fragments that are due."""
        names = {pace.name for pace in self._channels()}
        self._queues = {name: queue for name, queue in self._queues.items() if name in names}


def _replaces(new: _Waiting, old: _Waiting) -> bool:
    """Return whether a frame makes one that waits useless: of the same number and of another epoch.

    A frame whose first fragment was sent is completed: the receiver would lose both.
    """
    if new.frame.number != old.frame.number or _is_begun(old):
        return False
    return new.frame.epoch is None or new.frame.epoch != old.frame.epoch


def _is_begun(entry: _Waiting) -> bool:
    return entry.messages[0].flags & 7 not in (0, 1)
