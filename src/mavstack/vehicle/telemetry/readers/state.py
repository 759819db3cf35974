"""What the vehicle is doing: armed, mode, on the ground or in the air, home.

HEARTBEAT tells most. What a vehicle that sends HIGH_LATENCY2 alone leaves open stays open, but for what its
firmware puts into the fields for its own use: ArduPilot its base mode, PX4 the upper half of its custom mode.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.modes import mode_name
from mavstack.vehicle.telemetry.readers.conversions import known, place
from mavstack.vehicle.telemetry.values import HomePosition
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.vehicle.telemetry.telemetry import Telemetry

_ARDUPILOT, _PX4 = common.MavAutopilot.ARDUPILOTMEGA, common.MavAutopilot.PX4
_ON_GROUND: Final = common.MavLandedState.ON_GROUND
_MILLI = 1000.0
#: How far PX4's main and sub mode are moved down to fit into HIGH_LATENCY2.
_PX4_MODE_BITS = 16
#: For so long EXTENDED_SYS_STATE is believed rather than the heartbeat, in seconds.
_FRESH = 15.0


def read_armed(heard: Telemetry) -> bool | None:
    """The flag of HEARTBEAT."""
    info = heard.component.info
    if info is None:
        return None
    if not info.high_latency:
        return info.armed
    summary = heard.latest(common.HighLatency2)
    if summary is None or info.autopilot != _ARDUPILOT:
        return None
    return bool(summary.custom0 & common.MavModeFlag.SAFETY_ARMED)


def read_mode(heard: Telemetry) -> str | None:
    """Its name; None if the number has none that is known."""
    info = heard.component.info
    if info is None:
        return None
    if info.high_latency:
        return mode_name(info.autopilot, info.type, _whole_mode(info))
    return heard.component.modes.current or mode_name(info.autopilot, info.type, info.custom_mode)


def _whole_mode(info: ComponentInfo) -> int:
    return info.custom_mode << _PX4_MODE_BITS if info.autopilot == _PX4 else info.custom_mode


def read_system_status(heard: Telemetry) -> common.MavState | int | None:
    """The state of HEARTBEAT."""
    info = heard.component.info
    return None if info is None or info.high_latency else info.system_status


def read_landed_state(heard: Telemetry) -> common.MavLandedState | int | None:
    """EXTENDED_SYS_STATE."""
    told = heard.latest(common.ExtendedSysState)
    return None if told is None else known(told.landed_state, common.MavLandedState.UNDEFINED)


def read_vtol_state(heard: Telemetry) -> common.MavVtolState | int | None:
    """EXTENDED_SYS_STATE."""
    told = heard.latest(common.ExtendedSysState)
    return None if told is None else known(told.vtol_state, common.MavVtolState.UNDEFINED)


def read_in_air(heard: Telemetry) -> bool | None:
    """EXTENDED_SYS_STATE, or what ArduPilot's heartbeat says: it stands by on the ground."""
    info = heard.component.info
    if info is not None and not VehicleType.of(info.type).flies:
        return False
    landed, age = read_landed_state(heard), heard.age(common.ExtendedSysState)
    if landed is not None and age is not None and age <= _FRESH:
        return landed != _ON_GROUND
    if info is None or info.high_latency or info.autopilot != _ARDUPILOT:
        return None if landed is None else landed != _ON_GROUND
    if not info.armed or info.system_status == common.MavState.STANDBY:
        return False
    return True if info.system_status == common.MavState.ACTIVE else None


def read_home(heard: Telemetry) -> HomePosition | None:
    """HOME_POSITION."""
    told = heard.latest(common.HomePosition)
    where = None if told is None else place(told.latitude, told.longitude)
    return None if told is None or where is None else HomePosition(*where, told.altitude / _MILLI)
