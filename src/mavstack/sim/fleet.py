"""Fleets: start positions and links of many vehicles.

Vehicles of a fleet stand in rows, `SPACING` metres apart: the first at the given home, the others behind and
beside it relative to its heading. They share one link, or each has a link of its own on consecutive ports.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import cycle, islice
from math import ceil, cos, radians, sin, sqrt
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError, LinkURLError
from mavstack.links import parse_url
from mavstack.sim.motion import LocalFrame
from mavstack.sim.vehicle_types import (
    DEFAULT_HOME,
    ControllerFirmware,
    Firmware,
    Home,
    TerrainSource,
    VehicleType,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.services.version import FirmwareVersion
    from mavstack.sim.msp import SimulatedFlightController
    from mavstack.sim.rangefinders import Rangefinder
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle

SPACING = 10.0
MAX_PORT = 65535


@dataclass(frozen=True, slots=True)
class Fleet:
    """A fleet: the number of vehicles, their payloads, and the types and firmwares that they take in turn."""

    types: Sequence[VehicleType] = (VehicleType.COPTER,)
    firmwares: Sequence[Firmware] = (Firmware.ARDUPILOT,)
    count: int = 1
    home: Home = DEFAULT_HOME
    first_system: int = 1
    camera: bool = False
    gimbal: bool = False
    rangefinders: Sequence[Rangefinder] = ()
    terrain: TerrainSource = TerrainSource.FLAT
    remote_id: bool = False
    transponder: bool = False
    #: The version of ArduPilot; None for the newest supported version.
    version: FirmwareVersion | None = None
    #: Firmware of each vehicle that speaks MSP; `add_flight_controllers_to` adds these vehicles.
    controllers: Sequence[ControllerFirmware] = ()

    def add_to(self, simulation: Simulation) -> list[SimulatedVehicle]:
        """Add the fleet to a simulation.

        Args:
            simulation: The simulation.

        Returns:
            The vehicles.

        Raises:
            InvalidArgumentError: A system id would exceed 255, or is taken.
        """
        self._check_systems()
        types = islice(zip(cycle(self.types), cycle(self.firmwares), strict=False), self.count)
        return [
            simulation.add(
                vehicle_type,
                firmware,
                home=home,
                system=self.first_system + number,
                camera=self.camera,
                gimbal=self.gimbal,
                rangefinders=self.rangefinders,
                terrain=self.terrain,
                remote_id=self.remote_id,
                transponder=self.transponder,
                version=self.version if firmware is Firmware.ARDUPILOT else None,
            )
            for number, ((vehicle_type, firmware), home) in enumerate(zip(types, self.homes(), strict=True))
        ]

    def add_flight_controllers_to(self, simulation: Simulation) -> list[SimulatedFlightController]:
        """Add vehicles that speak MSP, with the firmwares of `controllers` in turn.

        Args:
            simulation: The simulation.

        Returns:
            The flight controllers.

        Raises:
            InvalidArgumentError: A system id would exceed 255, or is taken.
        """
        self._check_systems()
        firmwares = islice(cycle(self.controllers), self.count)
        return [
            simulation.add_flight_controller(firmware, home=home, system=self.first_system + number)
            for number, (firmware, home) in enumerate(zip(firmwares, self.homes(), strict=True))
        ]

    def _check_systems(self) -> None:
        if not 1 <= self.first_system <= self.first_system + self.count - 1 <= 255:
            raise InvalidArgumentError(
                f"{self.count} vehicles from system id {self.first_system} do not fit into ids 1 to 255"
            )

    def homes(self) -> Iterator[Home]:
        """Yield the home of each vehicle."""
        frame = LocalFrame(self.home.latitude, self.home.longitude, self.home.altitude)
        heading, columns = radians(self.home.heading), ceil(sqrt(self.count))
        for number in range(self.count):
            row, column = divmod(number, columns)
            back, right = -row * SPACING, column * SPACING
            north = back * cos(heading) - right * sin(heading)
            east = back * sin(heading) + right * cos(heading)
            latitude, longitude, _ = frame.to_global(north, east, 0.0)
            yield self.home._replace(latitude=latitude, longitude=longitude)


def link_per_vehicle(url: str, count: int) -> list[str]:
    """Return a link URL for each vehicle, on consecutive ports; raises LinkURLError."""
    parsed = parse_url(url)
    if not parsed.port or parsed.port + count - 1 > MAX_PORT:
        raise LinkURLError(f"link URL {url} needs a port, with {count} ports from it up to {MAX_PORT}")
    return [str(replace(parsed, port=parsed.port + number)) for number in range(count)]
