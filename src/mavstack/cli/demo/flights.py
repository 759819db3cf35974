"""What the vehicles of `mav demo` fly: seven types, a plan each, and the ground station that sends them.

The ground station is a node like any other: it uploads each plan, arms, and starts, over MAVLink. Each plan
jumps back to its beginning for ever; a vehicle that has come home with an empty battery gets a full one and
sets out again.
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
_FOR_EVER = -1.0
_AGAIN_AFTER = 5.0


@dataclass(frozen=True, slots=True)
class Flight:
    """One vehicle: where it begins, and the corners of what it flies, around a centre."""

    type: VehicleType
    firmware: Firmware
    #: Metres north and east of the field's middle, where it stands.
    place: tuple[float, float]
    #: The middle of its circuit from there, its radius, corners and height above home.
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


def populate(simulation: Simulation, field: Home = DEFAULT_HOME) -> list[SimulatedVehicle]:
    """Put the vehicles of all flights into a simulation."""
    return [simulation.add(flight.type, flight.firmware, home=home_of(flight, field)) for flight in FLIGHTS]


def home_of(flight: Flight, field: Home = DEFAULT_HOME) -> Home:
    """Where a flight begins."""
    frame = LocalFrame(field.latitude, field.longitude, field.altitude)
    latitude, longitude, _ = frame.to_global(*flight.place, 0.0)
    return Home(latitude, longitude, field.altitude)


def plan_of(flight: Flight, home: Home) -> Plan:
    """The mission of a flight from a home."""
    frame = LocalFrame(home.latitude, home.longitude, home.altitude)
    middle_north, middle_east = flight.centre
    items = [_take_off(flight, home)] if flight.type.flies else []
    first = len(items)
    for corner in range(flight.corners):
        angle = radians(360 * corner / flight.corners - 90)
        north, east = middle_north + flight.radius * sin(angle), middle_east + flight.radius * cos(angle)
        latitude, longitude, _ = frame.to_global(north, east, 0.0)
        items.append(_item(_CMD.NAV_WAYPOINT, latitude, longitude, flight.height))
    if flight.firmware is Firmware.ARDUPILOT:  # whose item 0 is home
        items.insert(0, _item(_CMD.NAV_WAYPOINT, home.latitude, home.longitude, 0.0))
        first += 1
    items.append(MissionItem(_CMD.DO_JUMP, first, _FOR_EVER, frame=common.MavFrame.MISSION))
    return Plan.of(items)


def _take_off(flight: Flight, home: Home) -> MissionItem:
    vtol = flight.type is VehicleType.VTOL
    command = _CMD.NAV_VTOL_TAKEOFF if vtol else _CMD.NAV_TAKEOFF
    return _item(command, home.latitude, home.longitude, flight.height)


def _item(command: int, latitude: float, longitude: float, height: float) -> MissionItem:
    return MissionItem(int(command), param5=latitude, param6=longitude, param7=height)


async def direct(ground: Node, vehicles: list[SimulatedVehicle]) -> None:
    """Let all vehicles fly, for ever."""
    async with asyncio.TaskGroup() as group:
        for flight, vehicle in zip(FLIGHTS, vehicles, strict=True):
            group.create_task(_keep_flying(ground, flight, vehicle))


async def _keep_flying(ground: Node, flight: Flight, vehicle: SimulatedVehicle) -> None:
    remote = await ground.wait_for_autopilot(vehicle.address.system)
    while True:
        try:
            await _start(remote, flight)
            await _end_of_flight(remote)
        except MavstackError:
            await asyncio.sleep(_AGAIN_AFTER)  # not ready yet: its own texts say why
        vehicle.faults.inject("battery 100")
        await asyncio.sleep(_AGAIN_AFTER)


async def _end_of_flight(remote: RemoteComponent) -> None:
    async with remote.stream(common.Heartbeat) as heartbeats:
        async for heartbeat in heartbeats:
            if not heartbeat.base_mode & common.MavModeFlag.SAFETY_ARMED:
                return


async def _start(remote: RemoteComponent, flight: Flight) -> None:
    await remote.mission.upload(plan_of(flight, home_of(flight)))
    if flight.firmware is Firmware.PX4:
        await remote.modes.set("MISSION")
        await remote.command(_CMD.COMPONENT_ARM_DISARM, 1)
    else:
        await remote.command(_CMD.COMPONENT_ARM_DISARM, 1)
        await remote.modes.set("AUTO")
        await remote.command(_CMD.MISSION_START)
