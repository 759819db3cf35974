"""Autopilots for tests that fly both a real one and the simulation of each firmware.

The environment variable MAVSTACK_AUTOPILOT holds the URL of a real autopilot, such as
`udpin://127.0.0.1:14550` for a SITL program that sends to this port. The tests arm and fly the vehicle. Run
PX4's SIH and ArduPilot's SITL in a network namespace of their own (`unshare -n sh -c 'ip link set lo up;
…'`), so that their packets reach no other host.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from math import cos, radians
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.telemetry.values import HomePosition

#: The environment variable with the URL of a real autopilot.
URL_VARIABLE = "MAVSTACK_AUTOPILOT"
#: Simulated seconds per real second.
SPEED = "8"
METRES_PER_DEGREE = 111_319.49
CMD, FRAME = common.MavCmd, common.MavFrame


@dataclass(frozen=True)
class Autopilot:
    """The URL of an autopilot, and whether it is a real one."""

    url: str
    is_real: bool


@contextmanager
def simulated(firmware: str, kind: str = "copter") -> Iterator[Autopilot]:
    """Run `mav sim` in a process of its own, on a free port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = (sys.executable, "-m", "mavstack", "sim", "--type", kind, "--firmware", firmware)
    options = ("--speed", SPEED, "--out", f"udpin://127.0.0.1:{port}")
    process = subprocess.Popen((*command, *options), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    try:
        yield Autopilot(f"udpout://127.0.0.1:{port}", is_real=False)
    finally:
        process.terminate()
        process.wait(timeout=20)


def real() -> str | None:
    """Return the URL of the real autopilot, or None."""
    return os.environ.get(URL_VARIABLE)


def offset_position(home: HomePosition, north: float, east: float) -> tuple[float, float]:
    """Return latitude and longitude, in degrees, of a point at an offset from home in metres."""
    latitude = home.latitude + north / METRES_PER_DEGREE
    return latitude, home.longitude + east / METRES_PER_DEGREE / cos(radians(home.latitude))


def is_ardupilot(vehicle: Vehicle) -> bool:
    """Return whether the firmware is ArduPilot."""
    return vehicle.autopilot == common.MavAutopilot.ARDUPILOTMEGA


def leg_length(vehicle: Vehicle) -> float:
    """Return the distance between waypoints, in metres; fixed wings need more."""
    return 300.0 if vehicle.vehicle_type.circles else 30.0


def cruise_altitude(vehicle: Vehicle) -> float:
    """Return the altitude to fly at, in metres above home."""
    if vehicle.vehicle_type is VehicleType.SUB:
        return -3.0
    return 60.0 if vehicle.vehicle_type.circles else 12.0 if vehicle.vehicle_type.flies else 0.0


def mission(vehicle: Vehicle, home: HomePosition) -> Plan:
    """Return a mission with a takeoff, two corners and a return, for this type of vehicle."""
    far, up = leg_length(vehicle), cruise_altitude(vehicle)
    items = [_item(CMD.NAV_WAYPOINT, home, 0, 0, 0)] if is_ardupilot(vehicle) else []  # its item 0 is home
    if vehicle.vehicle_type is VehicleType.VTOL:
        items.append(_item(CMD.NAV_VTOL_TAKEOFF, home, 0, 0, 30))
    elif vehicle.vehicle_type.flies:
        items.append(_item(CMD.NAV_TAKEOFF, home, far / 2, 0, up))
    items += [_item(CMD.NAV_WAYPOINT, home, far, 0, up), _item(CMD.NAV_WAYPOINT, home, far, far, up)]
    if vehicle.vehicle_type is VehicleType.PLANE:
        items += [_item(CMD.NAV_WAYPOINT, home, -2 * far, 0, up / 2), _item(CMD.NAV_LAND, home, 0, 0, 0)]
    elif vehicle.vehicle_type is VehicleType.VTOL:
        items.append(_item(CMD.NAV_VTOL_LAND, home, 0, 0, 0))
    elif vehicle.vehicle_type.flies:
        items.append(MissionItem(CMD.NAV_RETURN_TO_LAUNCH, frame=FRAME.MISSION))
    else:
        items.append(_item(CMD.NAV_WAYPOINT, home, 0, 0, up))
    return Plan.of(items)


def _item(command: int, home: HomePosition, north: float, east: float, up: float) -> MissionItem:
    latitude, longitude = offset_position(home, north, east)
    return MissionItem(command, param5=latitude, param6=longitude, param7=float(up))
