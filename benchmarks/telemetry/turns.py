"""One turn of one receiver: at the vehicle's own pace, or as much as it takes.

At the pace of the recording the sender notes when it hands each packet to the kernel, and the receiver's
function when it has been called with the message; both read the same monotonic clock. The n-th message of
an id from the end is the n-th packet of that id from the end, whatever came before the receiver listened.
The vehicle has been sending when the receiver is told to connect, `BEFORE_HEARTBEAT` before its next
heartbeat. CPU is that of the whole process over a window that begins `WARM_UP` later; then nothing is sent,
and what the process takes is what it takes idle.

A flood is half a second of the recording again and again, so that the vehicle's clock stands nearly still,
as it does for who hears much of it in a moment. No more than `WINDOW` messages are under way, as many as
every socket's buffer holds, so nothing is lost and the rate is the receiver's own.
"""

from __future__ import annotations

import socket
import statistics
import time
from bisect import bisect_left
from collections import defaultdict
from dataclasses import dataclass
from time import perf_counter_ns
from typing import TYPE_CHECKING, Self

from .child import UNKNOWN
from .receiver import Receiver
from .recording import HEARTBEAT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .receiver import Heard, Way
    from .recording import Due

BEFORE_HEARTBEAT = 0.5
WARM_UP = 3.0
IDLE = 2.0
LAST = 0.3  # for what is still under way
WINDOW = 64
STALLED = 0.1  # for so long nothing was heard: what is under way is lost
FLOOD_WARM_UP = 0.5
FLOOD_PART = 0.5
NANO = 1e9


@dataclass(frozen=True, slots=True)
class Paced:
    """A turn at the vehicle's pace: seconds, but for the rate."""

    cpu: float  # per packet that was sent
    idle: float  # CPU seconds a second
    median: float
    p99: float
    first: float
    lost: float
    rate: float


@dataclass(frozen=True, slots=True)
class Flooded:
    """A turn at full rate."""

    rate: float
    cpu: float
    lost: float


@dataclass(frozen=True, slots=True)
class _Sent:
    """What was sent, and when."""

    ids: Sequence[int]
    times: Sequence[int]


def paced(way: Way, packets: Sequence[Due]) -> Paced:
    """Send a recording at its own pace."""
    with Receiver(way) as receiver, _Sender(receiver.port) as sender:
        beats = [due.time for due in packets if due.message_id == HEARTBEAT]
        connect = beats[1] - BEFORE_HEARTBEAT
        sender.begin(packets[0].time)
        sender.send(packets, until=connect)
        receiver.connect()
        sender.send(packets, until=connect + WARM_UP)
        before, at = receiver.cpu, perf_counter_ns()
        sender.send(packets)
        time.sleep(LAST)
        cpu, end = receiver.cpu - before, perf_counter_ns()
        time.sleep(IDLE)
        idle = (receiver.cpu - before - cpu) * NANO / (perf_counter_ns() - end)
        return _paced(sender.sent, receiver.end(), at, cpu, idle)


def flood(way: Way, packets: Sequence[Due], seconds: float) -> Flooded:
    """Send as much as the receiver takes."""
    with Receiver(way) as receiver, _Sender(receiver.port) as sender:
        receiver.connect()
        sender.begin(packets[0].time)
        sender.send(packets, until=packets[0].time + WARM_UP)
        sender.flood(packets, receiver, FLOOD_WARM_UP)
        before, at, heard = receiver.cpu, perf_counter_ns(), receiver.count
        lost = sender.flood(packets, receiver, seconds)
        passed, delivered = (perf_counter_ns() - at) / NANO, receiver.count - heard
        cpu = receiver.cpu - before
        return Flooded(delivered / passed, cpu / max(delivered, 1), lost / (lost + delivered))


class _Sender:
    """The vehicle's socket."""

    def __init__(self, port: int) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._to = ("127.0.0.1", port)
        self._ids: list[int] = []
        self._times: list[int] = []
        self._origin = 0.0
        self._place = 0

    @property
    def sent(self) -> _Sent:
        """Everything that was sent at its pace."""
        return _Sent(self._ids, self._times)

    def begin(self, first: float) -> None:
        """The first packet is due now."""
        self._origin = time.perf_counter() - first

    def send(self, packets: Sequence[Due], until: float = float("inf")) -> None:
        """Go on with a recording until a time of its own."""
        send, to = self._socket.sendto, self._to
        while self._place < len(packets) and packets[self._place].time < until:
            due, data, message_id = packets[self._place]
            ahead = due + self._origin - time.perf_counter()
            if ahead > 0:
                time.sleep(ahead)
            self._times.append(perf_counter_ns())
            send(data, to)
            self._ids.append(message_id)
            self._place += 1

    def flood(self, packets: Sequence[Due], receiver: Receiver, seconds: float) -> int:
        """Keep the receiver busy, and wait for the last; how many it lost."""
        send, to = self._socket.sendto, self._to
        data = [due.data for due in packets if due.time < packets[0].time + FLOOD_PART]
        place, lost = 0, 0
        end = time.perf_counter() + seconds
        begun = heard = receiver.count
        moved = now = time.perf_counter()
        while now < end or place - lost > heard - begun:
            count = receiver.count
            if count != heard:
                heard, moved = count, now
            elif now > moved + STALLED:
                lost = place - (heard - begun)
            if now < end:
                for _ in range(WINDOW - (place - lost - (heard - begun))):
                    send(data[place % len(data)], to)
                    place += 1
            now = time.perf_counter()
        return lost

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()


def _paced(sent: _Sent, heard: Heard, begun: int, cpu: float, idle: float) -> Paced:
    """The figures of what was sent after `begun`."""
    latencies = _latencies(sent, heard, begun)
    start = bisect_left(sent.times, begun)
    ids = set(heard.ids)
    wanted = sum(UNKNOWN in ids or each in ids for each in sent.ids[start:])
    length = (sent.times[-1] - begun) / NANO
    return Paced(
        cpu=cpu / (len(sent.times) - start),
        idle=idle,
        median=statistics.median(latencies),
        p99=statistics.quantiles(latencies, n=100)[98],
        first=(heard.times[0] - heard.began) / NANO,
        lost=1 - len(latencies) / wanted,
        rate=(len(sent.times) - start) / length,
    )


def _latencies(sent: _Sent, heard: Heard, begun: int) -> list[float]:
    """From each packet's sending to the program's having it."""
    out, back = defaultdict[int, list[int]](list), defaultdict[int, list[int]](list)
    for message_id, at in zip(heard.ids, heard.times, strict=True):
        back[message_id].append(at)
    for message_id, at in zip(sent.ids, sent.times, strict=True):
        out[UNKNOWN if UNKNOWN in back else message_id].append(at)
    return [
        (there - here) / NANO
        for message_id, times in back.items()
        for here, there in zip(reversed(out[message_id]), reversed(times), strict=False)
        if here >= begun
    ]
