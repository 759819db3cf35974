"""Fleets: where many vehicles begin, and how they meet the world.

Vehicles of a fleet stand in rows, `SPACING` metres apart, the first one at the home that was given, the
others behind and beside it as its heading goes. They share one link, or each has one of its own, on ports
that count up from the first one's.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import cycle, islice
from math import ceil, cos, radians, sin, sqrt
from typing import TYPE_CHECKING

from mavstack.errors import LinkURLError, MavstackError
from mavstack.links import parse_url
from mavstack.sim.motion import LocalFrame
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle

SPACING = 10.0
LARGEST_PORT = 65535


@dataclass(frozen=True, slots=True)
class Fleet:
    """How many vehicles of which types; types and firmwares take turns."""

    types: Sequence[VehicleType] = (VehicleType.COPTER,)
    firmwares: Sequence[Firmware] = (Firmware.ARDUPILOT,)
    count: int = 1
    home: Home = DEFAULT_HOME
    first_system: int = 1

    def add_to(self, simulation: Simulation) -> list[SimulatedVehicle]:
        """Put the fleet into a simulation."""
        if not 1 <= self.first_system <= self.first_system + self.count - 1 <= 255:
            raise MavstackError(
                f"{self.count} vehicles from system {self.first_system} on do not fit into ids 1 to 255"
            )
        kinds = islice(zip(cycle(self.types), cycle(self.firmwares), strict=False), self.count)
        return [
            simulation.add(kind, firmware, home=home, system=self.first_system + number)
            for number, ((kind, firmware), home) in enumerate(zip(kinds, self.homes(), strict=True))
        ]

    def homes(self) -> Iterator[Home]:
        """Where each vehicle begins."""
        frame = LocalFrame(self.home.latitude, self.home.longitude, self.home.altitude)
        heading, columns = radians(self.home.heading), ceil(sqrt(self.count))
        for number in range(self.count):
            row, column = divmod(number, columns)
            back, right = -row * SPACING, column * SPACING
            north = back * cos(heading) - right * sin(heading)
            east = back * sin(heading) + right * cos(heading)
            latitude, longitude, _ = frame.to_global(north, east, 0.0)
            yield self.home._replace(latitude=latitude, longitude=longitude)


def own_links(url: str, count: int) -> list[str]:
    """A link for each vehicle: the port counts up from the URL's."""
    parsed = parse_url(url)
    if not parsed.port or parsed.port + count - 1 > LARGEST_PORT:
        raise LinkURLError(f"{url} has no {count} ports to count up from")
    return [str(replace(parsed, port=parsed.port + number)) for number in range(count)]
