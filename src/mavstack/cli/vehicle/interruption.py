"""The notice that a vehicle goes on with an action after Ctrl-C has ended only the command."""

from __future__ import annotations

import asyncio
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import echo
from mavstack.cli.vehicle.flight_progress import height_above_home

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.vehicle import Vehicle

#: For each action, the actions that stop it.
_STOPS: Final[Mapping[str, tuple[str, ...]]] = {
    "takeoff": ("hold", "land", "rtl"),
    "goto": ("hold", "land", "rtl"),
    "orbit": ("hold", "land", "rtl"),
    "yaw": ("hold",),
    "mission": ("hold", "land", "rtl"),
    "land": ("hold",),
    "rtl": ("hold", "land"),
}


@contextmanager
def notice_of_interruption(vehicle: Vehicle, action: str, prefix: str = "") -> Iterator[None]:
    """Say that the vehicle goes on, and how to stop it, if the block is cancelled.

    Args:
        vehicle: The vehicle that acts.
        action: Name of the action: takeoff, mission.
        prefix: Words before the commands that stop the action, such as `mav vehicle`; empty in the shell.
    """
    try:
        yield
    except asyncio.CancelledError:
        echo(interruption_text(vehicle, action, prefix), error=True)
        raise


def interruption_text(vehicle: Vehicle, action: str, prefix: str = "") -> str:
    """Return the notice for an action that is no longer watched."""
    if action == "reboot":
        return f"interrupted: vehicle {vehicle.system} goes on with its reboot"
    if vehicle.armed is False:
        return f"interrupted: vehicle {vehicle.system} is disarmed"
    height = height_above_home(vehicle)
    where = "" if height is None else f" ({height:.1f} m high)"
    options = f" --system {vehicle.system}" if prefix else ""
    stops = " or ".join(f"`{prefix}{each}{options}`" for each in _STOPS.get(action, ("hold",)))
    return f"interrupted: vehicle {vehicle.system} goes on with {action}{where}; {stops} stops it"
