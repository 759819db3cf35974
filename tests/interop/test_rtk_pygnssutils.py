"""The caster of pygnssutils in both versions of NTRIP: its stream reaches a simulated vehicle."""

from __future__ import annotations

import threading
from contextlib import contextmanager
from queue import Queue
from typing import TYPE_CHECKING

import pytest
from pygnssutils import socket_server

from mavstack import connect
from mavstack.sim import BackgroundSimulator
from tests.gnss.test_rtcm import msm, station

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = [pytest.mark.interop, pytest.mark.timeout(120)]


@contextmanager
def caster(version: str) -> Iterator[int]:
    """Run a caster with one epoch of corrections every 0.2 s; gives its port."""
    queue, ended = Queue(), threading.Event()

    def produce() -> None:
        epoch = 0
        while not ended.wait(0.2):
            queue.put(station().data + msm(1074, epoch, 360).data)
            epoch += 1

    server = socket_server.SocketServer(
        None, 1, 4, queue, ("127.0.0.1", 0), socket_server.ClientHandler,
        ntripversion=version, ntripuser="me", ntrippassword="secret",
    )  # fmt: skip
    threads = [threading.Thread(target=work, daemon=True) for work in (server.serve_forever, produce)]
    for thread in threads:
        thread.start()
    try:
        yield server.server_address[1]
    finally:
        ended.set()
        server.shutdown()
        server.server_close()


@pytest.mark.parametrize("version", ["1", "2"])
async def test_corrections_of_pygnssutils_fix_a_simulated_vehicle(version):
    with caster(f"{version}.0") as port, BackgroundSimulator() as simulator:
        async with connect(simulator.url) as connection:
            vehicle = await connection.wait_for_vehicle()
            url = f"ntrip://me:secret@127.0.0.1:{port}/pygnssutils?version={version}"
            async with vehicle.rtk.corrections(url):
                status = await vehicle.rtk.wait_for_fix(5, timeout=60)
                assert status.is_corrected
            assert vehicle.rtk.counts.numbers.keys() == {1005, 1074}
