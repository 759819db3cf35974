"""Attack by flood: one sender fills the queues of a link, and the packets of the others must not be lost."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.node import Node
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator

#: Sends 150 ATTITUDE at a time for 30 s; the second argument is the pause in seconds.
FLOOD = """
import socket, sys, time
from mavstack import Encoder
from mavstack.dialects import common
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sender.connect(("127.0.0.1", int(sys.argv[1])))
packet = Encoder(66, 1).encode(common.Attitude(roll=1.0))
end = time.time() + 30
while time.time() < end:
    time.sleep(float(sys.argv[2]))
    for _ in range(150):
        try:
            sender.send(packet)
        except OSError:
            pass
"""
#: Answers each COMMAND_LONG by a COMMAND_ACK.
VEHICLE = """
import socket, sys
from mavstack import Encoder, Parser
from mavstack.dialects import common
peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
peer.connect(("127.0.0.1", int(sys.argv[1])))
peer.settimeout(40)
encoder, parser = Encoder(1, 1), Parser(common)
peer.send(encoder.encode(common.Heartbeat(autopilot=common.MavAutopilot.PX4)))
while True:
    for packet in parser.feed(peer.recv(2048)):
        match packet.message:
            case common.CommandLong(command=command):
                peer.send(encoder.encode(common.CommandAck(command=command)))
"""
COMMANDS = 15


@contextmanager
def running(*programs: str, port: int, pause: float = 0) -> Iterator[None]:
    """Run Python programs, and kill them at the end."""
    arguments = [str(port), str(pause)]
    processes = [subprocess.Popen([sys.executable, "-c", program, *arguments]) for program in programs]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


async def wait_until_answered(node: Node, consecutive: int = 3) -> None:
    """Repeat a command until several of it are answered: by then the link has adapted itself to the flood."""
    command = common.MavCmd.DO_SET_MODE
    answered = 0
    async with node.stream(common.CommandAck, system=1) as acknowledgements:
        async with asyncio.timeout(20):
            while answered < consecutive:
                node.send(common.CommandLong(target_system=1, target_component=1, command=command))
                await asyncio.sleep(0.3)
                answered = answered + 1 if acknowledgements.drain() else 0


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("senders", "pause"), [(1, 0.004), (1, 0), (4, 0)], ids=["37,500/s", "unlimited", "4 unlimited"]
)
async def test_a_flood_loses_no_acknowledgement_of_another_sender(senders: int, pause: float) -> None:
    commands = list(common.MavCmd)[:COMMANDS]
    async with Node("udpin://127.0.0.1:0") as node:
        (link,) = node.links
        port = link.address[1]
        with running(VEHICLE, port=port):
            await node.wait_for_autopilot(1, timeout=30)
            with running(*[FLOOD] * senders, port=port, pause=pause):
                await wait_until(lambda: link.counters.chunks_in > 5000)
                await wait_until_answered(node)
                async with node.stream(common.CommandAck, system=1) as acknowledgements:
                    for command in commands:
                        node.send(common.CommandLong(target_system=1, target_component=1, command=command))
                        await asyncio.sleep(0.2)
                    await asyncio.sleep(1)
                    answered = {message.command for message in acknowledgements.drain()}
    assert len(answered) >= COMMANDS - 1  # the vehicle's own queue may lose one
