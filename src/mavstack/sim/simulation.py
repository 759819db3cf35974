"""A simulation: a world, its vehicles, and their time.

    simulation = Simulation(seed=1)
    copter = simulation.add(VehicleType.COPTER, Firmware.ARDUPILOT)
    simulation.advance(simulation.now + 10)

Time advances in steps of equal length, only when the caller advances it. Everything follows from the seed and
from the received data, so that the same seed gives the same bytes. A `Runner` advances it by the clock, a
test as fast as it can.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services import Address
from mavstack.services.terrain import TerrainMap
from mavstack.sim.motion import World
from mavstack.sim.parameters import Parameters
from mavstack.sim.profiles import profile_of
from mavstack.sim.rangefinders import MAX_RANGEFINDERS
from mavstack.sim.vehicle import SimulatedVehicle
from mavstack.sim.vehicle_types import (
    DEFAULT_HOME,
    ControllerFirmware,
    Firmware,
    Home,
    TerrainSource,
    VehicleType,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from mavstack.services.version import FirmwareVersion
    from mavstack.sim.faults import FaultTarget
    from mavstack.sim.motion.obstacles import Obstacle
    from mavstack.sim.msp import SimulatedFlightController
    from mavstack.sim.port import Port
    from mavstack.sim.rangefinders import Rangefinder

_LOG = logging.getLogger("mavstack.sim")

#: Default number of steps per second.
RATE = 50.0
#: Default Unix time of the start; constant, so that runs give equal results.
EPOCH = 1_767_225_600.0
MAX_SYSTEMS = 255
#: Number of bits that the number of a simulation has in the unique ids of its vehicles.
SITE_BITS = 40
#: Value of RNGFND1_TYPE for a simulated rangefinder, and value of PRX1_TYPE for a proximity sensor that
#: speaks MAVLink.
_SIMULATED, _OVER_MAVLINK = 100, 2
#: Tolerance in seconds when times are compared; Unix times in floats have a resolution of 0.25 µs.
ROUNDING = 1e-6


class Simulation:
    """Simulated vehicles in one world.

    Args:
        seed: The seed of wind, noise and all other random numbers.
        rate: Steps per second.
        start: The simulated Unix time of the start.
        storage: The folder of the vehicles' files and logs, one subfolder each; None keeps them in memory.
        site: A number that the unique ids of the vehicles' boards contain, so that the vehicles of two
            simulations can be told apart as real ones can; 0 to 2**40 - 1.
    """

    def __init__(
        self,
        *,
        seed: int = 1,
        rate: float = RATE,
        start: float = EPOCH,
        storage: Path | None = None,
        site: int = 0,
    ) -> None:
        self.world = World(seed=seed, rate=rate)
        self.seed = seed
        self.site = site
        #: The folder of the vehicles' files and logs; None to keep them in memory.
        self.storage = storage
        self.vehicles: list[SimulatedVehicle] = []
        #: Vehicles that speak MSP instead of MAVLink.
        self.flight_controllers: list[SimulatedFlightController] = []
        #: Callbacks that are called before each step with the simulated seconds since the start.
        self.before_step: list[Callable[[float], None]] = []
        self._start = start
        self._step = 0
        #: Length of a step, in seconds.
        self.step_length = 1.0 / rate

    @property
    def now(self) -> float:
        """The simulated Unix time, in seconds."""
        return self._start + self._step * self.step_length

    @property
    def elapsed(self) -> float:
        """Simulated seconds since the start."""
        return self._step * self.step_length

    def add(
        self,
        vehicle_type: VehicleType | str = VehicleType.COPTER,
        firmware: Firmware | str = Firmware.ARDUPILOT,
        *,
        home: Home = DEFAULT_HOME,
        system: int | None = None,
        camera: bool = False,
        gimbal: bool = False,
        rangefinders: Sequence[Rangefinder] = (),
        proximity: bool | None = None,
        terrain: TerrainSource | str = TerrainSource.FLAT,
        remote_id: bool = False,
        transponder: bool = False,
        version: FirmwareVersion | None = None,
    ) -> SimulatedVehicle:
        """Add a vehicle to the world.

        Args:
            vehicle_type: The vehicle type, such as "copter".
            firmware: The firmware, "ardupilot" or "px4".
            home: The start position.
            system: The system id; None for the next free one.
            camera: Give the vehicle a camera, a component of its own (component id 100).
            gimbal: Give the vehicle a gimbal, managed by the autopilot.
            rangefinders: Its rangefinders, at most six; none for the firmware's default.
            proximity: Give the vehicle a proximity sensor; None if there are obstacles.
            terrain: Where an ArduPilot vehicle has the heights of the terrain from.
            remote_id: Give the vehicle a Remote ID module (component id 236).
            transponder: Give the vehicle an ADS-B transponder (component id 156).
            version: The version of ArduPilot, 4.1 for one with other altitudes and radii; None: the newest.

        Returns:
            The vehicle, disarmed on the ground.

        Raises:
            InvalidArgumentError: The system id is taken, a value is out of range, or the version is of PX4.
        """
        _check_rangefinders(rangefinders)
        system = self._free_system(system)
        vehicle_type, firmware = VehicleType(vehicle_type), Firmware(firmware)
        vehicle = SimulatedVehicle(
            self.world.add(vehicle_type, home),
            vehicle_type,
            firmware,
            Address(system, common.MavComponent.AUTOPILOT1),
            profile_of(firmware, vehicle_type, version),
            Parameters(firmware, vehicle_type, system),
            now=self.now,
            folder=self.storage and self.storage / str(system),
            camera=camera,
            gimbal=gimbal,
            rangefinders=rangefinders,
            proximity=bool(self.world.obstacles) if proximity is None else proximity,
            terrain=_terrain_of(firmware, terrain),
            remote_id=remote_id,
            transponder=transponder,
            serial=_serial(self.site, len(self.vehicles) + 1),
        )
        return self._register(vehicle)

    def _register(self, vehicle: SimulatedVehicle) -> SimulatedVehicle:
        """Set the parameters of a vehicle's equipment, and let the world step the vehicle; return it."""
        _enable_equipment(vehicle)
        self.vehicles.append(vehicle)
        _LOG.info("vehicle %d added: %s %s", vehicle.address.system, vehicle.firmware, vehicle.vehicle_type)
        return vehicle

    def add_flight_controller(
        self,
        firmware: ControllerFirmware | str = ControllerFirmware.BETAFLIGHT,
        *,
        home: Home = DEFAULT_HOME,
        system: int | None = None,
    ) -> SimulatedFlightController:
        """Add a copter whose flight controller speaks MSP.

        Args:
            firmware: The firmware, "betaflight" or "inav".
            home: The start position.
            system: The number by which faults and events name it, as a system id; None for the next free one.

        Returns:
            The flight controller, disarmed on the ground.

        Raises:
            InvalidArgumentError: The number is taken or out of range.
        """
        from mavstack.sim.msp import SimulatedFlightController

        system = self._free_system(system)
        controller = SimulatedFlightController(
            self.world.add(VehicleType.COPTER, home),
            ControllerFirmware(firmware),
            Address(system, common.MavComponent.AUTOPILOT1),
            now=self.now,
            folder=self.storage and self.storage / str(system),
        )
        self.flight_controllers.append(controller)
        _LOG.info("vehicle %d added: %s copter", system, controller.firmware)
        return controller

    @property
    def fault_targets(self) -> Sequence[FaultTarget]:
        """The vehicles into which faults can be injected."""
        return (*self.vehicles, *self.flight_controllers)

    def add_obstacle(self, obstacle: Obstacle, *, home: Home = DEFAULT_HOME) -> None:
        """Add an obstacle to the world, before the vehicles that are to have a proximity sensor.

        Args:
            obstacle: The obstacle.
            home: The position from which its metres north and east count.

        Raises:
            InvalidArgumentError: The numbers of the obstacle are not possible.
        """
        self.world.add_obstacle(obstacle, home)

    def _free_system(self, system: int | None) -> int:
        """Return a system id, the next free one for None; raises if it is not free."""
        taken = {vehicle.address.system for vehicle in self.fault_targets}
        system = system or next((free for free in range(1, MAX_SYSTEMS + 1) if free not in taken), 0)
        if not 1 <= system <= MAX_SYSTEMS or system in taken:
            raise InvalidArgumentError(
                f"adding a vehicle failed: system id {system} is taken or outside 1 to {MAX_SYSTEMS}"
                if system
                else f"adding a vehicle failed: all {MAX_SYSTEMS} system ids are taken"
            )
        return system

    def step(self) -> None:
        """Advance by one step."""
        for act in self.before_step:
            act(self.elapsed)
        self.world.step()
        self._step += 1
        now = self.now
        for vehicle in self.vehicles:
            vehicle.step(now)
        for controller in self.flight_controllers:
            controller.step(now)

    def advance(self, now: float) -> None:
        """Advance by all steps up to the simulated Unix time `now`."""
        while self._start + (self._step + 1) * self.step_length <= now + ROUNDING:
            self.step()

    def close(self) -> None:
        """Finish the logs of all vehicles."""
        for vehicle in self.vehicles:
            vehicle.close()

    def data_to_send(self) -> list[tuple[SimulatedVehicle, Port, bytes]]:
        """Return the data sent by all vehicles since the last call."""
        return [(vehicle, port, data) for vehicle in self.vehicles for port, data in vehicle.data_to_send()]


def _serial(site: int, number: int) -> bytes:
    """Return the unique id of a board, which stays if its vehicle gets another system id."""
    return b"Mv" + site.to_bytes(SITE_BITS // 8, "big") + bytes([number & 0xFF])


def _check_rangefinders(rangefinders: Sequence[Rangefinder]) -> None:
    if len(rangefinders) > MAX_RANGEFINDERS:
        raise InvalidArgumentError(f"a vehicle has at most {MAX_RANGEFINDERS} rangefinders")


def _terrain_of(firmware: Firmware, terrain: TerrainSource | str) -> TerrainMap | None:
    """Return the map of a vehicle that asks for terrain; None for one that knows the flat ground."""
    asks = TerrainSource(terrain) is TerrainSource.REQUEST and firmware is Firmware.ARDUPILOT
    return TerrainMap() if asks else None


def _enable_equipment(vehicle: SimulatedVehicle) -> None:
    _enable_payloads(vehicle)
    _enable_distance_sensors(vehicle)


def _enable_payloads(vehicle: SimulatedVehicle) -> None:
    """Set ArduPilot's parameters by which it uses a camera, a gimbal and a transponder."""
    has = {"CAM1_TYPE": vehicle.camera, "MNT1_TYPE": vehicle.gimbal, "ADSB_TYPE": vehicle.transponder}
    for name, present in has.items():
        if present is not None and name in vehicle.parameters:
            vehicle.parameters.set(name, 1)


def _enable_distance_sensors(vehicle: SimulatedVehicle) -> None:
    """Set ArduPilot's parameters of the distance sensors that the vehicle has."""
    names = {f"RNGFND{number}_TYPE": _SIMULATED for number in range(1, len(vehicle.rangefinders) + 1)}
    if vehicle.proximity:
        names["PRX1_TYPE"] = _OVER_MAVLINK
    for name, value in names.items():
        if name in vehicle.parameters:
            vehicle.parameters.set(name, value)
