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


async def run_with(path, *packets: bytes) -> tuple[int, bytes]:
    """Run a node with a store; return how many of the packets it executes, and a command executed last."""
    store = None if path is None else TimestampStore(path)
    async with Target("udpin://127.0.0.1:0", timestamps=store) as target:
        for packet in packets:
            send_udp(target.port, packet)
        await asyncio.sleep(PAUSE)
        executed = target.executed
        send_udp(target.port, new := command_packet(time()))
        await asyncio.sleep(PAUSE)
        assert target.executed == executed + 1, "a new command is executed"
        return executed, new


async def test_a_command_is_not_executed_again_by_the_next_run(tmp_path) -> None:
    _, packet = await run_with(tmp_path / "clock")
    for _ in range(2):
        assert (await run_with(tmp_path / "clock", packet))[0] == 0


KILLED = """
import asyncio, os, socket, sys
from time import time
from tests.attacks.test_replay import Target, TimestampStore, command_packet, send_udp

async def work(path):
    async with Target("udpin://127.0.0.1:0", timestamps=TimestampStore(path)) as target:
        send_udp(target.port, packet := command_packet(time()))
        await asyncio.sleep(0.2)
        print(target.executed, packet.hex(), flush=True)
        os.kill(os.getpid(), 9)

asyncio.run(work(sys.argv[1]))
"""


async def run_killed(path) -> bytes:
    """Run a process that executes a command and is killed; return the command."""
    killed = await asyncio.to_thread(
        subprocess.run,
        [sys.executable, "-c", KILLED, str(path)],
        capture_output=True,
        text=True,
        timeout=60,
    )
    executed, packet = killed.stdout.split()
    assert executed == "1", killed.stderr
    return bytes.fromhex(packet)


async def test_a_command_is_not_executed_again_after_the_process_was_killed(tmp_path) -> None:
    packet = await run_killed(tmp_path / "clock")
    assert (await run_with(tmp_path / "clock", packet))[0] == 0


async def test_a_command_is_not_executed_by_the_second_run_after_a_kill(tmp_path) -> None:
    """The run in between receives nothing of the stream, and ends properly."""
    path = tmp_path / "clock"
    await run_with(path)
    packet = await run_killed(path)
    async with Target("udpin://127.0.0.1:0", timestamps=TimestampStore(path)) as target:
        send_udp(target.port, Encoder(254, 1, signing=KEY.signing()).encode(common.Heartbeat(), time()))
        await asyncio.sleep(PAUSE)
    assert (await run_with(path, packet))[0] == 0


async def test_a_command_is_not_executed_again_without_the_stored_state(tmp_path) -> None:
    _, packet = await run_with(tmp_path / "clock")
    (tmp_path / "clock").unlink()
    assert (await run_with(tmp_path / "clock", packet))[0] == 0
    assert (await run_with(None, packet))[0] == 0


async def test_a_command_is_not_executed_beside_a_process_with_the_same_store(tmp_path) -> None:
    path = tmp_path / "clock"
    async with Target("udpin://127.0.0.1:0", timestamps=TimestampStore(path)) as target:
        send_udp(target.port, packet := command_packet(time()))
        await asyncio.sleep(PAUSE)
        assert target.executed == 1
        assert (await run_with(path, packet))[0] == 0
    assert (await run_with(path, packet))[0] == 0
