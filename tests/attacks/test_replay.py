"""Attack by replay: a recorded signed COMMAND_LONG is sent again over other channels and to later runs."""

from __future__ import annotations

import asyncio
import socket
import subprocess
import sys
from time import time

from mavstack import Encoder
from mavstack.dialects import common
from mavstack.node import Node
from mavstack.security import SigningKey, TimestampStore

KEY = SigningKey.from_passphrase("replay")
PAUSE = 0.1


def command_packet(now: float) -> bytes:
    encoder = Encoder(255, 190, signing=KEY.signing())
    return encoder.encode(
        common.CommandLong(target_system=1, target_component=1, command=common.MavCmd.DO_SET_SERVO), now
    )


class Target(Node):
    """A node that counts the commands that it accepts: it executes a repeated one only after a while."""

    def __init__(self, url: str, **settings) -> None:
        super().__init__(url, system=1, component=1, signing=KEY, **settings)
        self.commands_received: list[object] = []
        self.add_packet_listener(common.CommandLong, self.commands_received.append)

    @property
    def executed(self) -> int:
        return len(self.commands_received)

    @property
    def port(self) -> int:
        return self.links[0].address[1]


def send_udp(port: int, data: bytes) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.sendto(data, ("127.0.0.1", port))


async def send_tcp(port: int, data: bytes) -> None:
    _, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(data)
    await asyncio.sleep(PAUSE)
    writer.close()


async def test_a_command_is_executed_once_however_many_udp_ports_send_it() -> None:
    async with Target("udpin://127.0.0.1:0") as target:
        packet = command_packet(time())
        for _ in range(20):
            send_udp(target.port, packet)
        await asyncio.sleep(PAUSE)
        assert target.executed == 1
        send_udp(target.port, command_packet(time()))
        await asyncio.sleep(PAUSE)
        assert target.executed == 2, "a new packet is accepted from a new port"


async def test_a_command_is_executed_once_over_several_tcp_connections() -> None:
    async with Target("tcpin://127.0.0.1:0") as target:
        packet = command_packet(time())
        for _ in range(5):
            await send_tcp(target.port, packet)
        assert target.executed == 1


async def test_a_command_is_not_executed_again_by_the_next_run(tmp_path) -> None:
    packet, executed = command_packet(time()), 0
    for _ in range(3):
        store = TimestampStore(tmp_path / "clock")
        async with Target("udpin://127.0.0.1:0", timestamps=store) as target:
            send_udp(target.port, packet)
            await asyncio.sleep(PAUSE)
            executed += target.executed
    assert executed == 1


KILLED = """
import asyncio, os, socket, sys
from tests.attacks.test_replay import Target, TimestampStore, send_udp

async def work(path, packet):
    async with Target("udpin://127.0.0.1:0", timestamps=TimestampStore(path)) as target:
        send_udp(target.port, packet)
        await asyncio.sleep(0.2)
        print(target.executed, flush=True)
        os.kill(os.getpid(), 9)

asyncio.run(work(sys.argv[1], bytes.fromhex(sys.argv[2])))
"""


async def test_a_command_is_not_executed_again_after_the_process_was_killed(tmp_path) -> None:
    packet, path = command_packet(time()), tmp_path / "clock"
    killed = await asyncio.to_thread(
        subprocess.run,
        [sys.executable, "-c", KILLED, str(path), packet.hex()],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert killed.stdout.strip() == "1", killed.stderr
    async with Target("udpin://127.0.0.1:0", timestamps=TimestampStore(path)) as target:
        send_udp(target.port, packet)
        await asyncio.sleep(PAUSE)
        assert target.executed == 0
        send_udp(target.port, command_packet(time()))
        await asyncio.sleep(PAUSE)
        assert target.executed == 1
