"""The router under traffic for minutes: nothing is lost, and the memory does not grow."""

from __future__ import annotations

import asyncio
import time
from typing import TYPE_CHECKING

import pytest

from mavstack.router.config import EndpointConfig, RouterConfig
from tests.router.peers import UdpPeer, heartbeat, port, routing, until

if TYPE_CHECKING:
    from collections.abc import Mapping

resource = pytest.importorskip("resource")

DURATION = 600.0
#: Packets per second, and growth of the process in kilobytes after a minute.
RATE, MAX_GROWTH = 500, 20_000
#: Place of the system id in a packet of MAVLink 2.
SYSTEM = 5
UDP = "udpin://127.0.0.1:0?trust_senders=yes"
NAMES = ("vehicle", "ground", "tablet", "box")


def report(stations: Mapping[int, UdpPeer]) -> None:
    """Send the heartbeats of ground stations: a silent peer is removed."""
    for number, peer in stations.items():
        peer.send(heartbeat(number))


def packets_of_vehicle(peer: UdpPeer) -> int:
    """Return the number of packets of the vehicle that wait at a ground station."""
    count = 0
    while True:
        try:
            count += peer.socket.recv(65536)[SYSTEM] == 1
        except BlockingIOError:
            return count


@pytest.mark.nightly
@pytest.mark.timeout(900)
async def test_ten_minutes_with_changes():
    endpoints = tuple(EndpointConfig(name, UDP) for name in NAMES)
    async with routing(*endpoints) as router:
        peers = [UdpPeer(port(router, name)) for name in NAMES]
        stations = dict(enumerate(peers[1:], 250))
        report(stations)
        await until(lambda: len(router.statistics().routes) == 3)
        sent = received = reports = 0
        begin = time.monotonic()
        memory = 0
        while (elapsed := time.monotonic() - begin) < DURATION:
            for _ in range(RATE // 10):
                peers[0].send(heartbeat(sequence=sent % 256))
                sent += 1
            extra = EndpointConfig("extra", UDP)
            await router.apply(RouterConfig((*endpoints, *((extra,) if sent % 3 else ()))))
            await asyncio.sleep(0.1)
            if elapsed > reports:
                reports += 1
                report(stations)
            received += packets_of_vehicle(peers[1])
            for peer in peers[2:]:
                peer.waiting()
            if elapsed > 60 and not memory:
                memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        await asyncio.sleep(0.5)
        received += packets_of_vehicle(peers[1])
        for peer in peers:
            peer.socket.close()
    assert received == sent
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory < MAX_GROWTH
