"""Autopilots that the same tests fly: a real one if there is one, and our own simulation of each firmware.

MAVSTACK_AUTOPILOT names the URL of a real one, such as `udpin://127.0.0.1:14550` for a SITL program that
sends there. It has to be one that may be flown: these tests arm it. PX4's SIH and ArduPilot's SITL are flown
in a network namespace of their own (`unshare -n sh -c 'ip link set lo up; …'`), since nothing then reaches
others.
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
from mavstack.vehicle.kinds import VehicleClass

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.telemetry.values import Home

#: The variable that names a real autopilot's URL.
VARIABLE = "MAVSTACK_AUTOPILOT"
#: How much faster than the clock the simulated ones are.
SPEED = "8"
METRES_A_DEGREE = 111_319.49
CMD, FRAME = common.MavCmd, common.MavFrame


@dataclass(frozen=True)
class Autopilot:
    """Where one is heard, and whether it is a real one."""

    url: str
    is_real: bool


@contextmanager
def simulated(firmware: str, kind: str = "copter") -> Iterator[Autopilot]:
    """`mav sim` as a process of its own, on a port that is free."""
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
    """The URL of the real autopilot, if there is one."""
    return os.environ.get(VARIABLE)


def place(home: Home, north: float, east: float) -> tuple[float, float]:
    """Degrees of a point in metres from home."""
    latitude = home.latitude + north / METRES_A_DEGREE
    return latitude, home.longitude + east / METRES_A_DEGREE / cos(radians(home.latitude))


def is_ardupilot(vehicle: Vehicle) -> bool:
    """Whether ArduPilot flies it."""
    return vehicle.autopilot == common.MavAutopilot.ARDUPILOTMEGA


def reach(vehicle: Vehicle) -> float:
    """How far apart the points of a flight are, in metres: a wing needs room."""
    return 300.0 if vehicle.kind.circles else 30.0


def height(vehicle: Vehicle) -> float:
    """How high to fly."""
    if vehicle.kind is VehicleClass.SUB:
        return -3.0
    return 60.0 if vehicle.kind.circles else 12.0 if vehicle.kind.flies else 0.0


def mission(vehicle: Vehicle, home: Home) -> Plan:
    """Up, around two corners, and back, as this class of vehicle does it."""
    far, up = reach(vehicle), height(vehicle)
    items = [_item(CMD.NAV_WAYPOINT, home, 0, 0, 0)] if is_ardupilot(vehicle) else []  # its item 0 is home
    if vehicle.kind is VehicleClass.VTOL:
        items.append(_item(CMD.NAV_VTOL_TAKEOFF, home, 0, 0, 30))
    elif vehicle.kind.flies:
        items.append(_item(CMD.NAV_TAKEOFF, home, far / 2, 0, up))
    items += [_item(CMD.NAV_WAYPOINT, home, far, 0, up), _item(CMD.NAV_WAYPOINT, home, far, far, up)]
    if vehicle.kind is VehicleClass.PLANE:
        items += [_item(CMD.NAV_WAYPOINT, home, -2 * far, 0, up / 2), _item(CMD.NAV_LAND, home, 0, 0, 0)]
    elif vehicle.kind is VehicleClass.VTOL:
        items.append(_item(CMD.NAV_VTOL_LAND, home, 0, 0, 0))
    elif vehicle.kind.flies:
        items.append(MissionItem(CMD.NAV_RETURN_TO_LAUNCH, frame=FRAME.MISSION))
    else:
        items.append(_item(CMD.NAV_WAYPOINT, home, 0, 0, up))
    return Plan.of(items)


def _item(command: int, home: Home, north: float, east: float, up: float) -> MissionItem:
    latitude, longitude = place(home, north, east)
    return MissionItem(command, param5=latitude, param6=longitude, param7=float(up))
