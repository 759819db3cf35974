"""Snapshots of a vehicle's state in a few groups, for buses that show states rather than messages.

Values have the names and units of the API (`mavstack.vehicle`): degrees, metres, metres per second, volts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.plain_json import plain

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.vehicle import Vehicle


def _status(vehicle: Vehicle) -> dict[str, Any]:
    info = vehicle.info
    return {
        "system": vehicle.system,
        "connected": vehicle.alive,
        "armed": vehicle.armed,
        "mode": vehicle.mode,
        "in_air": vehicle.in_air,
        "autopilot": None if info is None else info.autopilot,
        "type": None if info is None else info.type,
    }


def _position(vehicle: Vehicle) -> dict[str, Any] | None:
    position = vehicle.position
    return None if position is None else plain(position) | {"velocity": plain(vehicle.velocity)}


def _battery(vehicle: Vehicle) -> Any:
    batteries = vehicle.batteries
    return batteries[min(batteries)] if batteries else None


def _health(vehicle: Vehicle) -> dict[str, Any]:
    health = vehicle.health
    return {
        "ready": health.ready,
        "problems": [str(each) for each in health.problems],
        "warnings": [str(each) for each in health.warnings],
    }


#: The function that reads each group; it returns None if the vehicle has not reported the group.
GROUPS: Final[Mapping[str, Callable[[Vehicle], Any]]] = {
    "status": _status,
    "position": _position,
    "attitude": lambda vehicle: vehicle.attitude,
    "battery": _battery,
    "gps": lambda vehicle: vehicle.gps,
    "health": _health,
    "home": lambda vehicle: vehicle.home,
    "mission": lambda vehicle: vehicle.mission.progress,
}


def snapshot(vehicle: Vehicle, group: str) -> Any:
    """Return a group of a vehicle's state as JSON has it; None if the vehicle has not reported it."""
    return plain(GROUPS[group](vehicle))
