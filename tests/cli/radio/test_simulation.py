"""`mav radio sim` with modems: joined terminals, and an Iridium modem with its gateway."""

from __future__ import annotations

import asyncio
import os
import socket
import sys
from contextlib import suppress

import pytest

from mavstack.cli.main import main
from mavstack.cli.radio.simulation import run_simulation
from mavstack.cli.registry import command_parser
from mavstack.links.sbd_modem import checksum

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pseudo terminals")


async def simulated(*words: str) -> asyncio.Task[int]:
    """Start the simulation; it ends when it is cancelled."""
    arguments = command_parser("radio").parse_args(["sim", *words])
    task = asyncio.create_task(run_simulation(arguments))
    path = arguments.near
    while not os.path.exists(path):  # noqa: ASYNC240, PTH110
        assert not task.done(), task
        await asyncio.sleep(0.01)
    await asyncio.sleep(0.05)
    return task


async def read(descriptor: int, end: bytes) -> bytes:
    data = b""
    async with asyncio.timeout(20):
        while not data.endswith(end):
            with suppress(BlockingIOError):
                data += os.read(descriptor, 200)
            await asyncio.sleep(0.01)
    return data


def open_terminal(path: object) -> int:
    return os.open(str(path), os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)


async def test_modems_under_water_are_slow_in_both_directions(tmp_path):
    near, far = tmp_path / "near", tmp_path / "far"
    task = await simulated("--profile", "acoustic", "--near", str(near), "--far", str(far))
    ends, loop = [open_terminal(near), open_terminal(far)], asyncio.get_running_loop()
    for one, other in (ends, ends[::-1]):
        begun = loop.time()
        for _ in range(5):  # one in ten is lost
            os.write(one, b"hello")
            with suppress(TimeoutError):
                async with asyncio.timeout(1.5):
                    assert await read(other, b"hello")
                    break
        assert loop.time() - begun > 0.3
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)
    for end in ends:
        os.close(end)
    assert not near.is_symlink()


async def test_an_iridium_modem_and_its_gateway(tmp_path):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as gateway:
        gateway.bind(("127.0.0.1", 0))
        gateway.setblocking(False)
        url = f"udpout://127.0.0.1:{gateway.getsockname()[1]}"
        near = tmp_path / "modem"
        words = ["--profile", "sbd", "--near", str(near), "--gateway", url, "--session", "0.1"]
        task = await simulated(*words)
        modem, loop = open_terminal(near), asyncio.get_running_loop()
        os.write(modem, b"AT+SBDWB=5\r")
        await read(modem, b"READY\r\n")
        os.write(modem, b"hello" + checksum(b"hello"))
        await read(modem, b"OK\r\n")
        os.write(modem, b"AT+SBDIX\r")
        assert b"+SBDIX: 0, 1, 0" in await read(modem, b"OK\r\n")
        async with asyncio.timeout(10):
            data, address = await loop.sock_recvfrom(gateway, 400)
        assert data == b"hello"
        await loop.sock_sendto(gateway, b"climb", address)
        await asyncio.sleep(0.2)
        os.write(modem, b"AT+SBDIX\r")
        assert b", 1, 1, 5, 0" in await read(modem, b"OK\r\n")
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        os.close(modem)


def test_wrong_usage(capsys):
    assert main(["radio", "sim", "--profile", "sbd"]) == 2
    assert "--gateway" in capsys.readouterr().err
    assert main(["radio", "sim", "--profile", "acoustic", "--near", "a"]) == 2
    assert "needs --near and --far" in capsys.readouterr().err
    assert main(["radio", "sim", "--profile", "sbd", "--gateway", "nonsense"]) == 2
