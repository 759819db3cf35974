from __future__ import annotations

import asyncio

import pytest

from mavstack.bridges.msp import FlightController
from mavstack.cli.msp import connection
from mavstack.links import memory_pair
from mavstack.sim.virtual import run_virtually
from tests.bridges.msp.controllers import Firmware, run_firmware


@pytest.fixture
def firmware(monkeypatch):
    """A firmware that every command reaches, whatever device it names."""
    firmware = Firmware()

    def run(work):
        async def beside():
            near, far = memory_pair(asyncio.get_running_loop().time)
            monkeypatch.setattr(connection, "FlightController", lambda url: FlightController(near))
            task = asyncio.create_task(run_firmware(firmware, far))
            await asyncio.sleep(0)
            try:
                return await work
            finally:
                task.cancel()
                await asyncio.gather(task, return_exceptions=True)

        return run_virtually(beside())

    monkeypatch.setattr(asyncio, "run", run)
    return firmware
