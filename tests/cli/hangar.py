"""`mav` run in this process against simulated vehicles, in virtual time: one world for a row of calls."""

from __future__ import annotations

from mavstack.cli.common import connection
from mavstack.cli.shell import command as shell
from mavstack.links import MemoryNetwork
from mavstack.sim.runner import Runner
from mavstack.sim.scenarios import run_until
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.whole_flights.fleet import whisper

COPTER, PX4_COPTER = (VehicleType.COPTER, Firmware.ARDUPILOT), (VehicleType.COPTER, Firmware.PX4)


class Hangar:
    """Simulated vehicles that every command of `mav` reaches, whatever URL it is given."""

    def __init__(self, monkeypatch, mav, kinds, *, ready=True):
        self.mav = mav
        self.simulation = Simulation(seed=5)
        for kind, firmware in kinds:
            whisper(self.simulation.add(kind, firmware))
        if ready:
            for vehicle in self.simulation.vehicles:
                run_until(self.simulation, lambda vehicle=vehicle: vehicle.autopilot.booted)
            self.simulation.advance(self.simulation.now + 15.0)
            for vehicle in self.simulation.vehicles:
                vehicle.data_to_send()
        self.network = MemoryNetwork()
        monkeypatch.setattr(connection.asyncio, "run", self.run)
        monkeypatch.setattr(connection, "connect", self.connect)
        monkeypatch.setattr(shell, "connect", self.connect)

    @property
    def simulated(self):
        return self.simulation.vehicles[0]

    def connect(self, *urls):
        self.urls = urls
        return connect(self.network.link())

    def run(self, work):
        return run_virtually(self._beside(work))

    async def _beside(self, work):
        self.network = MemoryNetwork()
        async with Runner(self.simulation) as runner:
            await runner.connect(self.network.link(), self.simulation.vehicles)
            running = runner.start()
            code = await work
        if running.done() and not running.cancelled():
            running.result()
        return code
