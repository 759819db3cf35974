"""Quarantines and a changed `[firewall]`, through a whole router with real sockets."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mavstack import encode
from mavstack.dialects import common
from mavstack.router.config import parse_config
from mavstack.router.router import Router
from mavstack.wire import Encoder
from tests.router.peers import UdpPeer, heartbeat, names, port, until

CONFIG = """
[endpoint.vehicle]
url = "udpin://127.0.0.1:0"
[endpoint.ground]
url = "udpin://127.0.0.1:0"
[firewall]
default = "allow"
quarantine = "1 min"
"""


@pytest.mark.parametrize(
    ("before", "after", "stays"),
    [
        ('"1 min"', '"2 min"\nstatustext = true', True),
        ('quarantine = "1 min"', "", False),
        ('"1 min"', '"1 min"\ndry_run = true', False),
    ],
)
async def test_a_changed_firewall_keeps_quarantines(before, after, stays):
    config = parse_config(CONFIG)
    async with Router(config) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle, UdpPeer(port(router, "ground")) as stranger:
            for sequence in range(2):  # what answers may get more than three times what it sent
                vehicle.send(encode(common.CommandAck(command=400), system=1, component=1, sequence=sequence))
            stranger.send(heartbeat(255, 190))
            await vehicle.receive()
            stranger.send(Encoder(255, 190).encode(common.SerialControl(count=200)))
            guard = router.attachments.guard
            await until(lambda: guard.firewall.blocked("ground"))
            changed = parse_config(CONFIG.replace(before, after))
            await router.apply(replace(changed, endpoints=router.config.endpoints))
            assert bool(guard.firewall.blocked("ground")) is stays
            with UdpPeer(port(router, "ground")) as other:
                vehicle.waiting()
                stranger.send(heartbeat(255, 191))
                other.send(heartbeat(254, 190))
                received = [await vehicle.receive() for _ in range(1 if stays else 2)]
            systems = {data[5:7] for data in received}
            assert (bytes([255, 191]) in systems) is not stays
            assert bytes([254, 190]) in systems
            assert {name for data in received for name in names(data)} == {"HEARTBEAT"}
