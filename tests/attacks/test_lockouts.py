"""Attacks by many peers: ports and connections that fill a link, so that vehicles are locked out."""

from __future__ import annotations

import asyncio
import socket
from contextlib import ExitStack, contextmanager
from time import time
from typing import TYPE_CHECKING

import pytest

from mavstack import Encoder
from mavstack.dialects import common
from mavstack.node import Node
from mavstack.router.config import parse_config
from mavstack.router.router import Router
from mavstack.security import SigningKey
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator

KEY = SigningKey.from_passphrase("lockout")
HEARTBEAT = Encoder(77, 1).encode(common.Heartbeat(type=common.MavType.QUADROTOR))
FORGED = Encoder(77, 1, signing=SigningKey.from_passphrase("guess").signing(timestamp=1)).encode(
    common.Heartbeat(type=common.MavType.QUADROTOR)
)
FOUND_TIMEOUT = 8.0


@contextmanager
def udp_ports(count: int) -> Iterator[list[socket.socket]]:
    with ExitStack() as stack:
        yield [stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(count)]


async def send_from(ports: list[socket.socket], data: bytes, address: tuple[str, int]) -> None:
    for number, port in enumerate(ports):
        port.sendto(data, address)
        if number % 16 == 0:
            await asyncio.sleep(0.001)


def vehicle(url: str, key: SigningKey | None) -> Node:
    return Node(
        url,
        system=1,
        component=1,
        type=common.MavType.QUADROTOR,
        autopilot=common.MavAutopilot.PX4,
        signing=key,
    )


@pytest.mark.parametrize(
    ("key", "data"), [(KEY, b"x"), (KEY, FORGED), (None, b"\xfd\x09"), (None, HEARTBEAT)]
)
async def test_ports_that_fill_a_udp_link_lock_out_no_vehicle(key, data) -> None:
    with udp_ports(300) as ports:
        async with Node("udpin://127.0.0.1:0", signing=key) as ground:
            host, port = ground.links[0].address
            await send_from(ports, data, (host, port))
            assert len(ground.links[0].channels) == 256
            async with vehicle(f"udpout://{host}:{port}", key):
                await ground.wait_for_autopilot(1, timeout=FOUND_TIMEOUT)


async def test_a_verified_vehicle_keeps_its_channel_while_new_ports_come() -> None:
    with udp_ports(600) as ports:
        async with Node("udpin://127.0.0.1:0?max_peers=16", signing=KEY) as ground:
            host, port = ground.links[0].address
            async with vehicle(f"udpout://{host}:{port}", KEY) as flying:
                await ground.wait_for_autopilot(1, timeout=FOUND_TIMEOUT)
                (channel,) = ground.links[0].channels
                for data in (FORGED, HEARTBEAT, b"x"):
                    await send_from(ports, data, (host, port))
                assert flying.is_open
                assert not channel.closed
                assert len(ground.links[0].channels) == 16


@pytest.mark.parametrize("key", [KEY, None])
async def test_idle_tcp_connections_lock_out_no_vehicle(key) -> None:
    async with Node("tcpin://127.0.0.1:0", signing=key) as ground:
        host, port = ground.links[0].address
        idle = [await asyncio.open_connection(host, port) for _ in range(80)]
        async with vehicle(f"tcpout://{host}:{port}", key):
            await ground.wait_for_autopilot(1, timeout=FOUND_TIMEOUT)
            assert len(ground.links[0].channels) == 64
        for _, writer in idle:
            writer.close()


async def test_a_signed_vehicle_gets_in_while_unsigned_ports_keep_coming() -> None:
    """Before: new ports took the places that a full link frees per second, and the vehicle got none."""
    with udp_ports(400) as ports:
        async with Node("udpin://127.0.0.1:0?max_peers=16", signing=KEY) as ground:
            link = ground.links[0]
            host, port = link.address
            await send_from(ports, HEARTBEAT, (host, port))
            link._admission._admission._allowance = -1e9  # the others have used it up
            async with vehicle(f"udpout://{host}:{port}", KEY):
                await ground.wait_for_autopilot(1, timeout=FOUND_TIMEOUT)
            assert len(link.channels) == 16


#: A firewall as in the guide.
RULES = """
[firewall]
default = "deny"
quarantine = "1 min"
[[firewall.rule]]
endpoints = ["vehicle"]
systems = [1]
[[firewall.rule]]
endpoints = ["ground"]
systems = [255]
"""


@pytest.mark.parametrize(
    ("count", "query", "firewall"),
    [
        (20, "?max_peers=16", ""),
        (300, "?max_peers=16", ""),
        (300, "", ""),
        (
            300,
            "",
            RULES,
        ),
    ],
)
async def test_a_signed_pilot_gets_into_a_full_port_of_a_router(count, query, firewall, tmp_path) -> None:
    """Before: unsigned heartbeats from 300 ports took all places, and the pilot heard nothing."""
    KEY.save(tmp_path / "field.key")
    config = parse_config(
        f'''
        [endpoint.vehicle]
        url = "udpin://127.0.0.1:0"
        [endpoint.ground]
        url = "udpin://127.0.0.1:0{query}"
        [endpoint.ground.signing]
        in = "{tmp_path}/field.key"
        {firewall}
        '''
    )
    async with Router(config) as router:
        ports = {name: endpoint.address for name, endpoint in router.endpoints.items()}
        with udp_ports(count) as attackers, udp_ports(2) as (pilot, flying):
            await send_from(attackers, HEARTBEAT, ports["ground"])
            signed, plain = Encoder(255, 190, signing=KEY.signing()), Encoder(1, 1)
            pilot.setblocking(False)

            def is_heard() -> bool:
                beat = signed.encode(common.Heartbeat(type=common.MavType.GCS), time())
                pilot.sendto(beat, ports["ground"])
                flying.sendto(plain.encode(common.Heartbeat(autopilot=3)), ports["vehicle"])
                try:
                    return bool(pilot.recv(4096))
                except BlockingIOError:
                    return False

            await wait_until(is_heard, timeout=FOUND_TIMEOUT)
