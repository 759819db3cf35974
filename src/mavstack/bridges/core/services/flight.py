"""Actions of flight: takeoff, goto, landing, return and missions, each with feedback and a reason."""

from __future__ import annotations

from math import degrees, isnan, nan
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.frames import ned_to_enu_yaw
from mavstack.bridges.core.row import Action
from mavstack.geodesy import distance

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle

Fields = dict[str, Any]


def _altitude(vehicle: Vehicle) -> float:
    position = vehicle.position
    known = None if position is None else position.relative_altitude
    return nan if known is None else known


def _distance(vehicle: Vehicle, latitude: float, longitude: float) -> float:
    position = vehicle.position
    if position is None:
        return nan
    return distance(position.latitude, position.longitude, latitude, longitude)


async def takeoff(vehicle: Vehicle, goal: Fields) -> None:
    """Take off to metres above home."""
    await vehicle.takeoff(goal["altitude"])


async def land(vehicle: Vehicle, _goal: Fields) -> None:
    """Land."""
    await vehicle.land()


async def goto(vehicle: Vehicle, goal: Fields) -> None:
    """Go to a position, metres above home; NaN keeps the altitude, and leaves the yaw to the vehicle."""
    altitude, yaw = goal["altitude"], goal["yaw"]
    await vehicle.goto(
        goal["latitude"],
        goal["longitude"],
        None if isnan(altitude) else altitude,
        yaw=None if isnan(yaw) else degrees(ned_to_enu_yaw(yaw)) % 360.0,
    )


async def return_to_launch(vehicle: Vehicle, _goal: Fields) -> None:
    """Return to home."""
    await vehicle.rtl()


async def fly_mission(vehicle: Vehicle, _goal: Fields) -> None:
    """Arm if needed, and fly the mission to its end."""
    await vehicle.mission.fly()


def height(vehicle: Vehicle, _goal: Fields) -> Fields:
    """Return the altitude above home."""
    return {"altitude": _altitude(vehicle)}


def way_to_goal(vehicle: Vehicle, goal: Fields) -> Fields:
    """Return the altitude, and the distance from the goal."""
    away = _distance(vehicle, goal["latitude"], goal["longitude"])
    return {"altitude": _altitude(vehicle), "distance": away}


def way_home(vehicle: Vehicle, _goal: Fields) -> Fields:
    """Return the altitude, and the distance from home."""
    home = vehicle.home
    away = nan if home is None else _distance(vehicle, home.latitude, home.longitude)
    return {"altitude": _altitude(vehicle), "distance": away}


def mission_progress(vehicle: Vehicle, _goal: Fields) -> Fields:
    """Return the current item and the number of items."""
    progress = vehicle.mission.progress
    if progress is None:
        return {}
    return {"item": progress.seq, "items": min(progress.total, 0xFFFF)}


_P: Final = "mavstack_msgs/action/"
ROWS: Final = (
    Action(
        "action/takeoff",
        f"{_P}Takeoff",
        takeoff,
        height,
        meaning="Vehicle.takeoff, m above home",
        required=("altitude",),
    ),
    Action(
        "action/goto",
        f"{_P}Goto",
        goto,
        way_to_goal,
        meaning="Vehicle.goto; yaw in rad from east",
        required=("latitude", "longitude"),
    ),
    Action("action/land", f"{_P}Land", land, height, meaning="Vehicle.land"),
    Action("action/rtl", f"{_P}ReturnToLaunch", return_to_launch, way_home, meaning="Vehicle.rtl"),
    Action("action/mission", f"{_P}FlyMission", fly_mission, mission_progress, meaning="Vehicle.mission.fly"),
)
