"""The values of a vehicle in groups, as JSON: the slow state, and telemetry with rounded numbers.

Values are in SI units and degrees, as the properties of `Vehicle` have them. None stands for a value that the
vehicle does not report; a group without any value is None.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.enum_names import enum_name
from mavstack.bridges.core.plain_json import plain
from mavstack.bridges.core.snapshots import snapshot
from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.vehicle import Vehicle

Group = dict[str, Any]
#: Decimals of latitude and longitude in degrees (about a centimetre), and of all other numbers.
_PLACE_DECIMALS: Final = 7
_DECIMALS: Final = 3
_PLACES: Final = ("latitude", "longitude")
#: The number of mission items that means that the vehicle does not report this number.
_NO_TOTAL: Final = 0xFFFF


def state(vehicle: Vehicle) -> Group:
    """Return the slow state: connection, mode, armed, readiness, firmware, mission."""
    progress = vehicle.mission.progress
    version = vehicle.version
    return {
        **snapshot(vehicle, "status"),
        "autopilot": enum_name(common.MavAutopilot, vehicle.autopilot),
        "type": vehicle.vehicle_type.value,
        "version": None if version is None else str(version.flight),
        "status": enum_name(common.MavState, vehicle.system_status),
        **snapshot(vehicle, "health"),
        "home": rounded(snapshot(vehicle, "home")),
        "mission_item": None if progress is None else progress.seq,
        "mission_items": None if progress is None or progress.total == _NO_TOTAL else progress.total,
    }


def speed(vehicle: Vehicle) -> Group | None:
    """Return speeds in m/s, throttle in percent, and the wind."""
    hud, velocity, wind = vehicle.vfr_hud, vehicle.velocity, vehicle.wind
    if hud is None and velocity is None:
        return None
    found = plain(hud) or {"airspeed": None, "throttle": None}
    found.pop("climb", None)
    found |= {"ground_speed": vehicle.ground_speed, "climb_rate": vehicle.climb_rate}
    found |= {"velocity": plain(velocity), "wind_speed": None if wind is None else wind.speed}
    return found


@dataclass(frozen=True, slots=True)
class TelemetryGroup:
    """A group of telemetry: its content in words, and the function that reads it."""

    content: str
    read: Callable[[Vehicle], Any]


#: The groups of telemetry by name.
GROUPS: Final[Mapping[str, TelemetryGroup]] = {
    "position": TelemetryGroup(
        "degrees, metres above sea level and above home, heading", partial(snapshot, group="position")
    ),
    "attitude": TelemetryGroup("roll, pitch, yaw in degrees", partial(snapshot, group="attitude")),
    "speed": TelemetryGroup("m/s, throttle in percent, wind", speed),
    "battery": TelemetryGroup("volts, amperes, percent", partial(snapshot, group="battery")),
    "gps": TelemetryGroup("fix, satellites, accuracies", partial(snapshot, group="gps")),
}


def telemetry(vehicle: Vehicle, group: str) -> Group | None:
    """Return a group of telemetry; None if the vehicle reports none of its values."""
    found = rounded(plain(GROUPS[group].read(vehicle)))
    return found if isinstance(found, dict) else None


def rounded(value: Any, name: str = "") -> Any:
    """Return a JSON value with its numbers rounded, by the names of their fields."""
    if isinstance(value, float):
        return round(value, _PLACE_DECIMALS if name in _PLACES else _DECIMALS) + 0.0
    if isinstance(value, list):
        return [rounded(each, name) for each in value]
    if isinstance(value, dict):
        return {key: rounded(each, key) for key, each in value.items()}
    return value
