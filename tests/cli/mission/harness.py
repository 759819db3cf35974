"""A simulated vehicle for several `mav mission` commands, one after the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common import connection
from mavstack.cli.mission import show, transfer
from mavstack.links import MemoryNetwork
from mavstack.sim.runner import Runner
from mavstack.sim.scenarios import run_until
from mavstack.sim.simulation import Simulation
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.running import reduce_telemetry

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Awaitable, Callable

    import pytest

    from mavstack.vehicle import Vehicle

    Work = Callable[[Vehicle], Awaitable[int]]


class CommandTarget:
    """A simulated vehicle; the commands of a test run on it one after the other."""

    def __init__(self, firmware: str) -> None:
        self.simulation = Simulation(seed=3)
        self.vehicle = self.simulation.add("copter", firmware)
        reduce_telemetry(self.vehicle)
        run_until(self.simulation, lambda: self.vehicle.autopilot.booted)
        self.simulation.advance(self.simulation.now + 20.0)
        self.vehicle.data_to_send()

    def run_on_vehicle(self, arguments: Namespace, work: Work) -> int:
        return run_virtually(self._run(arguments, work))

    async def _run(self, arguments: Namespace, work: Work) -> int:
        network = MemoryNetwork()
        async with Runner(self.simulation) as runner:
            await runner.connect(network.link(), [self.vehicle])
            running = runner.start()
            async with connect(network.link()) as node:
                code = await work(await node.wait_for_vehicle(arguments.system, timeout=arguments.timeout))
            if running.done():
                running.result()
        return code


def run_commands_on(
    monkeypatch: pytest.MonkeyPatch, run_on_vehicle: Callable[[Namespace, Work], int]
) -> None:
    for module in (connection, transfer, show):
        monkeypatch.setattr(module, "run_on_vehicle", run_on_vehicle)
