"""One turn of one receiver: at the pace of the vehicle, or at full rate.

At the pace of the recording, the sender records when it passes each packet to the kernel, and the receiver's
function when it is called with the message; both read the same monotonic clock. Messages and packets of an id
are paired from the end, so that packets sent before the receiver listened do not matter. The receiver
connects `CONNECT_LEAD` before a heartbeat of the vehicle, which is sending already. CPU is that of the whole
process during a window that begins `WARM_UP_TIME` later; then nothing is sent, and the CPU of the process is
its idle load.

A flood repeats half a second of the recording, so that the vehicle's clock hardly advances. Many datagrams
leave per system call, from another core than that of the receiver. At most `WINDOW` messages are in transit,
which every socket buffer can hold, so no message is lost and the rate is that of the receiver.
"""

from __future__ import annotations

import socket
import statistics
import time
from bisect import bisect_left
from collections import defaultdict
from dataclasses import dataclass
from itertools import cycle
from time import perf_counter_ns
from typing import TYPE_CHECKING, Self

from benchmarks.datagrams import BATCH, batches
from benchmarks.measure import apart

from .child import UNKNOWN
from .receiver import Receiver
from .recording import HEARTBEAT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .receiver import Method, Received
    from .recording import TimedPacket

CONNECT_LEAD = 0.5
WARM_UP_TIME = 3.0
IDLE_TIME = 2.0
DRAIN_TIME = 0.3  # seconds for messages in transit
WINDOW = 160
STALL_TIMEOUT = 0.1  # seconds without a message after which those in transit count as lost
FLOOD_WARM_UP_TIME = 0.5
FLOOD_EXCERPT = 0.5
NANO = 1e9


@dataclass(frozen=True, slots=True)
class Paced:
    """The result of a turn at the pace of the vehicle, in seconds, except for the rate."""

    cpu: float  # per packet that was sent
    idle: float  # CPU seconds per second
    median: float
    p99: float
    first: float
    lost: float
    rate: float


@dataclass(frozen=True, slots=True)
class Flooded:
    """The result of a turn at full rate."""

    rate: float
    cpu: float
    lost: float


@dataclass(frozen=True, slots=True)
class _Sent:
    """The sent message ids and their times."""

    ids: Sequence[int]
    times: Sequence[int]


def paced(method: Method, packets: Sequence[TimedPacket]) -> Paced:
    """Send a recording at its own pace."""
    with Receiver(method) as receiver, _Sender(receiver.port) as sender:
        heartbeat_times = [packet.time for packet in packets if packet.message_id == HEARTBEAT]
        connect = heartbeat_times[1] - CONNECT_LEAD
        sender.begin(packets[0].time)
        sender.send(packets, until=connect)
        receiver.connect()
        sender.send(packets, until=connect + WARM_UP_TIME)
        before, at = receiver.cpu, perf_counter_ns()
        sender.send(packets)
        time.sleep(DRAIN_TIME)
        cpu, end = receiver.cpu - before, perf_counter_ns()
        time.sleep(IDLE_TIME)
        idle = (receiver.cpu - before - cpu) * NANO / (perf_counter_ns() - end)
        return _paced(sender.sent, receiver.end(), at, cpu, idle)


def flood(method: Method, packets: Sequence[TimedPacket], seconds: float) -> Flooded:
    """Send as much as the receiver can process."""
    with Receiver(method) as receiver, apart(), _Sender(receiver.port) as sender:
        receiver.connect()
        sender.begin(packets[0].time)
        sender.send(packets, until=packets[0].time + WARM_UP_TIME)
        sender.flood(packets, receiver, FLOOD_WARM_UP_TIME)
        before, at, received = receiver.cpu, perf_counter_ns(), receiver.count
        lost = sender.flood(packets, receiver, seconds)
        elapsed, delivered = (perf_counter_ns() - at) / NANO, receiver.count - received
        cpu = receiver.cpu - before
        return Flooded(delivered / elapsed, cpu / max(delivered, 1), lost / (lost + delivered))


class _Sender:
    """The socket of the vehicle."""

    def __init__(self, port: int) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._address = ("127.0.0.1", port)
        self._ids: list[int] = []
        self._times: list[int] = []
        self._origin = 0.0
        self._index = 0

    @property
    def sent(self) -> _Sent:
        """Everything sent at the pace of the recording."""
        return _Sent(self._ids, self._times)

    def begin(self, first: float) -> None:
        """Set the time of the first packet to now."""
        self._origin = time.perf_counter() - first

    def send(self, packets: Sequence[TimedPacket], until: float = float("inf")) -> None:
        """Continue a recording until a time of the recording."""
        send, to = self._socket.sendto, self._address
        while self._index < len(packets) and packets[self._index].time < until:
            packet_time, data, message_id = packets[self._index]
            ahead = packet_time + self._origin - time.perf_counter()
            if ahead > 0:
                time.sleep(ahead)
            self._times.append(perf_counter_ns())
            send(data, to)
            self._ids.append(message_id)
            self._index += 1

    def flood(self, packets: Sequence[TimedPacket], receiver: Receiver, seconds: float) -> int:
        """Keep the receiver busy, and wait for the last message; return the number of lost ones."""
        data = [packet.data for packet in packets if packet.time < packets[0].time + FLOOD_EXCERPT]
        sent = cycle(batches(data))
        self._socket.connect(self._address)
        index, lost = 0, 0
        end = time.perf_counter() + seconds
        begun = received = receiver.count
        moved = now = time.perf_counter()
        while now < end or index - lost > received - begun:
            count = receiver.count
            if count != received:
                received, moved = count, now
            elif now > moved + STALL_TIMEOUT:
                lost = index - (received - begun)
            if now < end and index - lost - (received - begun) + BATCH <= WINDOW:
                next(sent).send(self._socket)
                index += BATCH
            now = time.perf_counter()
        return lost

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()


def _paced(sent: _Sent, received: Received, begun: int, cpu: float, idle: float) -> Paced:
    """Return the figures of the packets sent after `begun`."""
    latencies = _latencies(sent, received, begun)
    start = bisect_left(sent.times, begun)
    ids = set(received.ids)
    expected = sum(UNKNOWN in ids or each in ids for each in sent.ids[start:])
    length = (sent.times[-1] - begun) / NANO
    return Paced(
        cpu=cpu / (len(sent.times) - start),
        idle=idle,
        median=statistics.median(latencies),
        p99=statistics.quantiles(latencies, n=100)[98],
        first=(received.times[0] - received.began) / NANO,
        lost=1 - len(latencies) / expected,
        rate=(len(sent.times) - start) / length,
    )


def _latencies(sent: _Sent, received: Received, begun: int) -> list[float]:
    """Return the times from sending each packet to its arrival in the program."""
    sent_times, received_times = defaultdict[int, list[int]](list), defaultdict[int, list[int]](list)
    for message_id, at in zip(received.ids, received.times, strict=True):
        received_times[message_id].append(at)
    for message_id, at in zip(sent.ids, sent.times, strict=True):
        sent_times[UNKNOWN if UNKNOWN in received_times else message_id].append(at)
    return [
        (received_at - sent_at) / NANO
        for message_id, times in received_times.items()
        for sent_at, received_at in zip(reversed(sent_times[message_id]), reversed(times), strict=False)
        if sent_at >= begun
    ]
