"""Simulated vehicles for commands: each `mav` reaches them over a memory network, in virtual time.

The simulation lives on between one command and the next, so what one sets another finds.
"""

from __future__ import annotations

import asyncio
import shlex
from types import SimpleNamespace
from typing import TYPE_CHECKING

from mavstack.cli.common import connection
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.whole_flights.fleet import whisper

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Coroutine

    import pytest

    from mavstack.node import RemoteComponent
    from mavstack.sim.vehicle import Vehicle

EXAMPLE = "  mav "


class Hangar:
    """A vehicle that the commands of a test reach in place of any URL."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, firmware: str = "ardupilot", seed: int = 3) -> None:
        self.simulation = Simulation(seed=seed)
        self.vehicle: Vehicle = self.simulation.add("copter", firmware)
        whisper(self.vehicle)
        #: What another ground station does while a command runs.
        self.meanwhile: Callable[[RemoteComponent], Awaitable[None]] | None = None
        self._network = MemoryNetwork()
        monkeypatch.setattr(connection, "connect", self._connect)
        monkeypatch.setattr(connection, "asyncio", SimpleNamespace(run=self._run))

    def put(self, path: str, data: bytes) -> None:
        """Put a file onto the vehicle."""
        self.vehicle.storage.store[path] = data

    def file(self, path: str) -> bytes | None:
        """A file of the vehicle, if it is there."""
        store = self.vehicle.storage.store
        return bytes(store[path]) if path in store else None

    def has_directory(self, path: str) -> bool:
        try:
            self.vehicle.storage.store.list_directory(path)
        except OSError:
            return False
        return True

    def _connect(self, *urls: str, **options: object):
        return connect(self._network.link(), **options)

    def _run(self, work: Coroutine[None, None, int]) -> int:
        return run_virtually(self._whole(work))

    async def _whole(self, work: Coroutine[None, None, int]) -> int:
        self._network = MemoryNetwork()
        async with Runner(self.simulation) as runner:
            await runner.connect(self._network.link(), self.simulation.vehicles)
            running = runner.start()
            if self.meanwhile is None:
                code = await work
            else:
                async with Node(self._network.link(), system=254) as other:
                    beside = asyncio.create_task(self.meanwhile(await other.autopilot()))
                    code = await work
                    await beside
            if running.done():
                running.result()
            return code


def examples_of(text: str) -> list[list[str]]:
    """The commands that the help of a command shows, as words without `mav`."""
    lines = [line.removeprefix(EXAMPLE) for line in text.splitlines() if line.startswith(EXAMPLE)]
    return [shlex.split(line) for line in lines]
