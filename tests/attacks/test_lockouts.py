"""Attacks by many peers: ports and connections that fill a link, so that vehicles are locked out."""

from __future__ import annotations

import asyncio
import socket
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

import pytest

from mavstack import Encoder
from mavstack.dialects import common
from mavstack.node import Node
from mavstack.security import SigningKey

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
