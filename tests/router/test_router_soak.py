"""The router under traffic for minutes: nothing is lost, and the memory does not grow."""

from __future__ import annotations

import asyncio
import time

import pytest

from mavstack.router.config import EndpointConfig, RouterConfig
from tests.router.peers import UdpPeer, heartbeat, port, routing, until

resource = pytest.importorskip("resource")

DURATION = 600.0
#: Packets per second, and growth of the process in kilobytes after a minute.
RATE, MAX_GROWTH = 500, 20_000
UDP = "udpin://127.0.0.1:0"
NAMES = ("vehicle", "ground", "tablet", "box")


@pytest.mark.nightly
@pytest.mark.timeout(900)
async def test_ten_minutes_with_changes():
    endpoints = tuple(EndpointConfig(name, UDP) for name in NAMES)
    async with routing(*endpoints) as router:
        peers = [UdpPeer(port(router, name)) for name in NAMES]
        for number, peer in enumerate(peers[1:], 250):
            peer.send(heartbeat(number))
        await until(lambda: len(router.statistics().routes) == 3)
        sent = received = 0
        begin = time.monotonic()
        memory = 0
        while (elapsed := time.monotonic() - begin) < DURATION:
            for _ in range(RATE // 10):
                peers[0].send(heartbeat(sequence=sent % 256))
                sent += 1
            extra = EndpointConfig("extra", UDP)
            await router.apply(RouterConfig((*endpoints, *((extra,) if sent % 3 else ()))))
            await asyncio.sleep(0.1)
            received += peers[1].waiting()
            for peer in peers[2:]:
                peer.waiting()
            if elapsed > 60 and not memory:
                memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        await asyncio.sleep(0.5)
        received += peers[1].waiting()
        for peer in peers:
            peer.socket.close()
    # The other ground stations' first heartbeats arrive too.
    assert sent <= received <= sent + 3
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory < MAX_GROWTH
