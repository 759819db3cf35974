"""Closing a node in the middle of an FTP transfer: the other end keeps no session, whatever is lost."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.links import Impairment, MemoryNetwork, impair
from mavstack.node import Node
from mavstack.node.driver import RELEASE_TIMEOUT
from mavstack.sim.virtual import run_virtually
from tests.node.vehicle import Vehicle

MOMENTS = [0.0, 0.05, 0.11, 0.23, 0.4, 0.6, 0.9, 1.3, 1.8, 2.4]


async def interrupt(moment: float, seed: int, *, upload: bool, silent: bool = False) -> tuple[int, float]:
    """Cancel a transfer and close the node; return the sessions that are left, and the time to close."""
    network = MemoryNetwork()
    link = impair(network.link(), Impairment(loss=0.2, latency=0.02, seed=seed))
    async with Vehicle(network.link()) as vehicle:
        ground = await Node(link).open()
        remote = await ground.wait_for_autopilot()
        ftp = remote.ftp
        work = ftp.upload("big.bin", bytes(60_000)) if upload else ftp.download("logs/flight.bin")
        transfer = asyncio.create_task(work)
        await asyncio.sleep(moment)
        if silent:
            await vehicle.close()
        transfer.cancel()
        await asyncio.gather(transfer, return_exceptions=True)
        before = asyncio.get_running_loop().time()
        await ground.close()
        return len(vehicle.ftp.sessions), asyncio.get_running_loop().time() - before


@pytest.mark.parametrize("upload", [False, True], ids=["download", "upload"])
@pytest.mark.parametrize(("seed", "moment"), list(enumerate(MOMENTS)))
def test_no_session_is_left(seed, moment, upload):
    left, _ = run_virtually(interrupt(moment, seed, upload=upload))
    assert left == 0


def test_a_silent_vehicle_holds_the_end_up_for_a_moment_only():
    _, duration = run_virtually(interrupt(0.4, 1, upload=False, silent=True))
    assert duration <= RELEASE_TIMEOUT + 0.01
