"""The vehicles in a log: systems with an autopilot."""

from __future__ import annotations

from dataclasses import dataclass

_MAX_ID = 255


def is_system_id(value: float) -> bool:
    """Return whether the value of a parameter can be a system id."""
    return 1 <= value <= _MAX_ID


@dataclass(frozen=True, slots=True)
class LogVehicle:
    """A vehicle in a log.

    Attributes:
        system: System id; 0 in logs that a vehicle writes itself and that do not name it.
        component: Component id of the autopilot.
        vehicle_type: Name of its MAV_TYPE, such as "QUADROTOR", or empty.
        autopilot: Name of its firmware, such as "ARDUPILOTMEGA" or "PX4", or empty.
        heartbeats: Number of heartbeats of the autopilot in the log.
    """

    system: int
    component: int = 1
    vehicle_type: str = ""
    autopilot: str = ""
    heartbeats: int = 0
