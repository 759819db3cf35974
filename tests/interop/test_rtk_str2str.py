"""RTKLIB's str2str as a caster: its stream reaches a simulated vehicle by `vehicle.rtk`."""

from __future__ import annotations

import asyncio
import shutil
import socket
from contextlib import closing

import pytest

from mavstack import connect
from mavstack.sim import BackgroundSimulator
from tests.gnss.test_rtcm import msm, station

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(shutil.which("str2str") is None, reason="str2str (Debian: rtklib) is not installed"),
]


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


async def base(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    with closing(writer):
        for epoch in range(10_000):
            writer.write(station().data + msm(1074, epoch, 360).data)
            await asyncio.sleep(0.2)


@pytest.mark.smoke
async def test_the_caster_of_rtklib():
    server = await asyncio.start_server(base, "127.0.0.1", 0)
    quiet = asyncio.subprocess.DEVNULL
    source, port = server.sockets[0].getsockname()[1], free_port()
    words = ["str2str", "-in", f"tcpcli://127.0.0.1:{source}", "-out", f"ntripc://me:secret@:{port}/NEAR"]
    program = await asyncio.create_subprocess_exec(*words, stdout=quiet, stderr=quiet)
    try:
        with BackgroundSimulator() as simulator:
            async with connect(simulator.url) as connection:
                vehicle = await connection.wait_for_vehicle()
                async with vehicle.rtk.corrections(f"ntrip://me:secret@127.0.0.1:{port}/NEAR"):
                    status = await vehicle.rtk.wait_for_fix(5, timeout=40)
                    assert status.is_corrected
                assert vehicle.rtk.counts.numbers.keys() == {1005, 1074}
    finally:
        program.terminate()
        await program.wait()
        server.close()
