"""The flights of `mav demo`: seven vehicles of different types, a mission for each, and their ground station.

The ground station is an ordinary node: it uploads each mission, arms and starts the vehicle over MAVLink.
Each mission jumps back to its beginning without end. A vehicle that has returned with an empty battery gets a
full one and starts again.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from math import cos, radians, sin
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.services.mission import MissionItem, Plan
from mavstack.sim.motion import LocalFrame
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType

if TYPE_CHECKING:
    from mavstack.node import Node, RemoteComponent
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle

_CMD = common.MavCmd
_T, _F = VehicleType, Firmware
_UNLIMITED_JUMPS = -1.0
_RETRY_DELAY = 5.0


@dataclass(frozen=True, slots=True)
class Flight:
    """One vehicle with its home, and the polygon that it flies."""

    type: VehicleType
    firmware: Firmware
    #: Home of the vehicle: metres north and east of the demo's home.
    place: tuple[float, float]
    #: Centre of the polygon in metres north and east of the vehicle's home; radius and height in metres.
    centre: tuple[float, float]
    radius: float
    corners: int
    height: float


FLIGHTS: Final = (
    Flight(_T.COPTER, _F.ARDUPILOT, (0, 0), (70, -60), 55, 4, 20),
    Flight(_T.COPTER, _F.PX4, (0, 20), (70, 80), 55, 6, 30),
    Flight(_T.PLANE, _F.ARDUPILOT, (-20, -60), (60, 10), 240, 8, 60),
    Flight(_T.VTOL, _F.PX4, (-20, 60), (90, 20), 310, 6, 80),
    Flight(_T.ROVER, _F.ARDUPILOT, (-40, 0), (-70, -70), 45, 5, 0),
    Flight(_T.BOAT, _F.ARDUPILOT, (-60, 110), (-60, 60), 50, 3, 0),
    Flight(_T.SUB, _F.ARDUPILOT, (-90, 170), (-30, 30), 25, 4, -8),
)


def add_vehicles(simulation: Simulation, field: Home = DEFAULT_HOME) -> list[SimulatedVehicle]:
    """Add the vehicles of all flights to a simulation."""
    return [
        simulation.add(flight.type, flight.firmware, home=flight_home(flight, field)) for flight in FLIGHTS
    ]


def flight_home(flight: Flight, field: Home = DEFAULT_HOME) -> Home:
    """Return the home of the vehicle of a flight."""
    frame = LocalFrame(field.latitude, field.longitude, field.altitude)
    latitude, longitude, _ = frame.to_global(*flight.place, 0.0)
    return Home(latitude, longitude, field.altitude)


def flight_plan(flight: Flight, home: Home) -> Plan:
    """Return the mission of a flight."""
    frame = LocalFrame(home.latitude, home.longitude, home.altitude)
    middle_north, middle_east = flight.centre
    items = [_take_off(flight, home)] if flight.type.flies else []
    first = len(items)
    for corner in range(flight.corners):
        angle = radians(360 * corner / flight.corners - 90)
        north, east = middle_north + flight.radius * sin(angle), middle_east + flight.radius * cos(angle)
        latitude, longitude, _ = frame.to_global(north, east, 0.0)
        items.append(_item(_CMD.NAV_WAYPOINT, latitude, longitude, flight.height))
    if flight.firmware is Firmware.ARDUPILOT:  # item 0 of ArduPilot's missions is the home position
        items.insert(0, _item(_CMD.NAV_WAYPOINT, home.latitude, home.longitude, 0.0))
        first += 1
    items.append(MissionItem(_CMD.DO_JUMP, first, _UNLIMITED_JUMPS, frame=common.MavFrame.MISSION))
    return Plan.of(items)


def _take_off(flight: Flight, home: Home) -> MissionItem:
    vtol = flight.type is VehicleType.VTOL
    command = _CMD.NAV_VTOL_TAKEOFF if vtol else _CMD.NAV_TAKEOFF
    return _item(command, home.latitude, home.longitude, flight.height)


def _item(command: int, latitude: float, longitude: float, height: float) -> MissionItem:
    return MissionItem(int(command), param5=latitude, param6=longitude, param7=height)


async def fly_missions(ground: Node, vehicles: list[SimulatedVehicle]) -> None:
    """Have all vehicles fly their missions until cancelled."""
    async with asyncio.TaskGroup() as group:
        for flight, vehicle in zip(FLIGHTS, vehicles, strict=True):
            group.create_task(_fly_repeatedly(ground, flight, vehicle))


async def _fly_repeatedly(ground: Node, flight: Flight, vehicle: SimulatedVehicle) -> None:
    remote = await ground.wait_for_autopilot(vehicle.address.system)
    while True:
        try:
            await _start(remote, flight)
            await end_of_flight(remote)
        except MavstackError:
            await asyncio.sleep(_RETRY_DELAY)  # the vehicle is not ready to fly yet; its status texts say why
        vehicle.faults.inject("battery 100")
        await asyncio.sleep(_RETRY_DELAY)


async def end_of_flight(remote: RemoteComponent) -> None:
    """Wait until a vehicle is disarmed."""
    async with remote.stream(common.Heartbeat) as heartbeats:
        async for heartbeat in heartbeats:
            if not heartbeat.base_mode & common.MavModeFlag.SAFETY_ARMED:
                return


async def _start(remote: RemoteComponent, flight: Flight) -> None:
    await remote.mission.upload(flight_plan(flight, flight_home(flight)))
    if flight.firmware is Firmware.PX4:
        await remote.modes.set("MISSION")
        await remote.command(_CMD.COMPONENT_ARM_DISARM, 1)
    else:
        await remote.command(_CMD.COMPONENT_ARM_DISARM, 1)
        await remote.modes.set("AUTO")
        await remote.command(_CMD.MISSION_START)
