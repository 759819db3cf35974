"""A simulation: a world, the vehicles in it, and their time, which goes on only when it is told to.

    simulation = Simulation(seed=1)
    copter = simulation.add(VehicleType.COPTER, Firmware.ARDUPILOT)
    simulation.advance(simulation.now + 10)

Time goes in steps of equal length, and everything follows from the seed and from what comes in, so that the
same seed gives the same bytes. A runner advances it by a clock, a test as fast as it can.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.services import Address
from mavstack.sim.motion import World
from mavstack.sim.parameters import Parameters
from mavstack.sim.profiles import profile_of
from mavstack.sim.vehicle import SimulatedVehicle
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from mavstack.sim.port import Port

#: Steps a second.
RATE = 50.0
#: The Unix time at which a simulation begins if nobody says when: the same for all, so that runs are alike.
EPOCH = 1_767_225_600.0
MOST_SYSTEMS = 255
#: Unix times are floats good to a quarter of a microsecond.
ROUNDING = 1e-6


class Simulation:
    """Vehicles in one world."""

    def __init__(
        self, *, seed: int = 1, rate: float = RATE, start: float = EPOCH, storage: Path | None = None
    ) -> None:
        self.world = World(seed=seed, rate=rate)
        self.seed = seed
        #: Where vehicles keep their files, each in a folder of its own; in memory if there is no such place.
        self.storage = storage
        self.vehicles: list[SimulatedVehicle] = []
        #: Called before each step with the simulated seconds since the start.
        self.before_step: list[Callable[[float], None]] = []
        self._start = start
        self._step = 0
        #: Of a step, in seconds.
        self.length = 1.0 / rate

    @property
    def now(self) -> float:
        """The simulated Unix time."""
        return self._start + self._step * self.length

    @property
    def elapsed(self) -> float:
        """The simulated seconds since the start."""
        return self._step * self.length

    def add(
        self,
        type: VehicleType | str = VehicleType.COPTER,  # noqa: A002 (HEARTBEAT's name for it)
        firmware: Firmware | str = Firmware.ARDUPILOT,
        *,
        home: Home = DEFAULT_HOME,
        system: int | None = None,
    ) -> SimulatedVehicle:
        """Put a vehicle into the world, with the next free system id unless it is given."""
        taken = {vehicle.address.system for vehicle in self.vehicles}
        system = system or next((free for free in range(1, MOST_SYSTEMS + 1) if free not in taken), 0)
        if not 1 <= system <= MOST_SYSTEMS or system in taken:
            raise MavstackError(f"there is no system id left for another vehicle: {system or 'all'} taken")
        kind, profile = VehicleType(type), Firmware(firmware)
        vehicle = SimulatedVehicle(
            self.world.add(kind, home),
            kind,
            profile,
            Address(system, common.MavComponent.AUTOPILOT1),
            profile_of(profile, kind),
            Parameters(profile, kind, system),
            self.now,
            folder=self.storage and self.storage / str(system),
        )
        self.vehicles.append(vehicle)
        return vehicle

    def step(self) -> None:
        """One step of everything."""
        for act in self.before_step:
            act(self.elapsed)
        self.world.step()
        self._step += 1
        now = self.now
        for vehicle in self.vehicles:
            vehicle.step(now)

    def advance(self, now: float) -> None:
        """All steps until `now`; a step that is due within a rounding error is due."""
        while self._start + (self._step + 1) * self.length <= now + ROUNDING:
            self.step()

    def close(self) -> None:
        """Finish what vehicles are writing."""
        for vehicle in self.vehicles:
            vehicle.close()

    def data_to_send(self) -> list[tuple[SimulatedVehicle, Port, bytes]]:
        """What all vehicles sent since the last call."""
        return [(vehicle, port, data) for vehicle in self.vehicles for port, data in vehicle.data_to_send()]
