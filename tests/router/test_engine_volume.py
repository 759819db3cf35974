"""Packets through four links of different kinds: every byte arrives at the other three, in order."""

from __future__ import annotations

import socket
from contextlib import ExitStack
from itertools import cycle, islice
from random import Random
from time import monotonic
from typing import TYPE_CHECKING

import pytest

from mavstack import Encoder
from mavstack.dialects import ardupilotmega
from mavstack.links.stream import send_at_once
from mavstack.router import RouterEngine
from mavstack.security import SigningKey
from tests.router.packets import unknown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

TIMEOUT = 20.0
#: Packets that are under way at a time: what the default buffer of a UDP socket holds.
BATCH = 100
POOL = 2000
MESSAGES = (
    lambda random: ardupilotmega.Heartbeat(custom_mode=random.randrange(1 << 32)),
    lambda random: ardupilotmega.Attitude(roll=random.random(), yawspeed=random.random()),
    lambda random: ardupilotmega.Statustext(text="x" * random.randrange(50)),
    lambda random: ardupilotmega.GpsRawInt(lat=random.randrange(1 << 30), eph=random.randrange(100)),
    lambda random: ardupilotmega.GpsInjectData(data=random.randbytes(110), len=110),
)


class End:
    """The other end of an endpoint of the engine."""

    prefix = False

    def __init__(self, stream: socket.socket) -> None:
        self.stream = stream
        stream.settimeout(TIMEOUT)

    def send(self, packets: Sequence[bytes]) -> None:
        self.stream.sendall(self.joined(packets))

    def joined(self, packets: Sequence[bytes]) -> bytes:
        """The bytes of packets on the link."""
        if not self.prefix:
            return b"".join(packets)
        return b"".join(part for packet in packets for part in (len(packet).to_bytes(4, "big"), packet))

    def receive(self, packets: Sequence[bytes]) -> bytes:
        """As many bytes as these packets have."""
        expected = len(self.joined(packets))
        received = bytearray()
        while len(received) < expected:
            received += self.stream.recv(1 << 16)
        return bytes(received)


class Framed(End):
    prefix = True


class Datagrams(End):
    def send(self, packets: Sequence[bytes]) -> None:
        for packet in packets:
            self.stream.send(packet)

    def receive(self, packets: Sequence[bytes]) -> bytes:
        return b"".join(self.stream.recv(1 << 16) for _ in packets)


class Queue(End):
    def __init__(self, engine: RouterEngine) -> None:
        self.engine, self.number = engine, engine.add_queue(name="queue")

    def send(self, packets: Sequence[bytes]) -> None:
        assert self.engine.push(self.number, b"".join(packets))

    def receive(self, packets: Sequence[bytes]) -> bytes:
        received: list[bytes] = []
        end = monotonic() + TIMEOUT
        while len(received) < len(packets) and monotonic() < end:
            received += self.engine.pull(self.number)
        return b"".join(received)


def links(engine: RouterEngine, sockets: ExitStack) -> list[End]:
    """A UDP peer, a TCP connection, a framed Unix connection and a queue."""
    listener, peer = (
        sockets.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(2)
    )
    for each in (listener, peer):
        each.bind(("127.0.0.1", 0))
    peer.connect(listener.getsockname())
    engine.add_udp(listener.fileno(), name="udp", peer=peer.getsockname())
    with socket.create_server(("127.0.0.1", 0)) as server:
        tcp = sockets.enter_context(socket.create_connection(server.getsockname()))
        with server.accept()[0] as accepted:
            send_at_once(accepted)
            engine.add_stream(accepted.fileno(), name="tcp")
    ours, framed = socket.socketpair()
    with ours:
        engine.add_stream(ours.fileno(), name="framed", framing="length")
    return [Datagrams(peer), End(tcp), Framed(sockets.enter_context(framed)), Queue(engine)]


def traffic(system: int, count: int) -> Iterator[list[bytes]]:
    """Batches of packets without a target: both versions, signed ones, unknown ones, all lengths."""
    random = Random(system)
    plain, old = Encoder(system, 1), Encoder(system, 1, version=1)
    signed = Encoder(system, 1, signing=SigningKey(bytes(range(32))).signing())
    pool = [
        unknown(plain)
        if number % 50 == 0
        else random.choice((plain, old, signed)).encode(random.choice(MESSAGES)(random))
        for number in range(POOL)
    ]
    batches = [pool[start : start + BATCH] for start in range(0, POOL, BATCH)]
    return islice(cycle(batches), count // BATCH)


@pytest.mark.parametrize(
    "count", [4000, pytest.param(10_000_000, marks=[pytest.mark.nightly, pytest.mark.timeout(1800)])]
)
def test_no_byte_is_changed_or_lost(count):
    with RouterEngine(ardupilotmega) as engine, ExitStack() as sockets:
        ends = links(engine, sockets)
        engine.statistics()  # all are open
        for batches in zip(*(traffic(system, count // 4) for system in range(1, 5)), strict=True):
            for sender, packets in zip(ends, batches, strict=True):
                sender.send(packets)
                for other in ends:
                    if other is not sender:
                        assert other.receive(packets) == other.joined(packets)
        counted = engine.statistics().endpoints.values()
        assert [(each.received, each.sent) for each in counted] == [(count // 4, count // 4 * 3)] * 4
        assert not any(each.dropped or each.bad_bytes for each in counted)
