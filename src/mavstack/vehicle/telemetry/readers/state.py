"""The readers of the vehicle's state: armed, mode, on the ground or in the air, home.

HEARTBEAT holds most of it. HIGH_LATENCY2 has no field for some of it; firmwares put parts of that into the
fields for their own use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.modes import mode_name
from mavstack.vehicle.telemetry.readers.conversions import known, location
from mavstack.vehicle.telemetry.values import HomePosition
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.vehicle.telemetry.telemetry import Telemetry

_ON_GROUND: Final = common.MavLandedState.ON_GROUND
_MILLI = 1000.0
#: The height in metres, the speed in m/s and the throttle in percent above which a vehicle flies.
_FLIGHT_HEIGHT: Final = 5.0
_FLIGHT_SPEED: Final = 8.0
_FLIGHT_THROTTLE: Final = 15
#: The largest age in seconds of the messages with these values.
_EVIDENCE_AGE: Final = 5.0
#: The largest age in seconds up to which EXTENDED_SYS_STATE is preferred to the heartbeat.
_MAX_AGE = 15.0


def read_armed(telemetry: Telemetry) -> bool | None:
    """Return the armed flag of HEARTBEAT."""
    info = telemetry.component.info
    if info is None:
        return None
    if not info.high_latency:
        return info.armed
    summary = telemetry.latest(common.HighLatency2)
    return None if summary is None else telemetry.firmware.high_latency_armed(summary)


def read_mode(telemetry: Telemetry) -> str | None:
    """Return the name of the mode; None if its number has no known name."""
    info = telemetry.component.info
    if info is None:
        return None
    if info.high_latency:
        mode = telemetry.firmware.high_latency_mode(info.custom_mode)
        return mode_name(info.autopilot, info.type, mode)
    return telemetry.component.modes.current or mode_name(info.autopilot, info.type, info.custom_mode)


def read_system_status(telemetry: Telemetry) -> common.MavState | int | None:
    """Return the state of HEARTBEAT."""
    info = telemetry.component.info
    return None if info is None or info.high_latency else info.system_status


def read_landed_state(telemetry: Telemetry) -> common.MavLandedState | int | None:
    """Return the landed state of EXTENDED_SYS_STATE."""
    message = telemetry.latest(common.ExtendedSysState)
    return None if message is None else known(message.landed_state, common.MavLandedState.UNDEFINED)


def read_vtol_state(telemetry: Telemetry) -> common.MavVtolState | int | None:
    """Return the VTOL state of EXTENDED_SYS_STATE."""
    message = telemetry.latest(common.ExtendedSysState)
    return None if message is None else known(message.vtol_state, common.MavVtolState.UNDEFINED)


def read_in_air(telemetry: Telemetry) -> bool | None:
    """Return whether the vehicle flies, from EXTENDED_SYS_STATE, the heartbeat, or its height and speed."""
    info = telemetry.component.info
    if info is not None and not VehicleType.of(info.type).flies:
        return False
    landed, age = read_landed_state(telemetry), telemetry.age(common.ExtendedSysState)
    if landed is not None and age is not None and age <= _MAX_AGE:
        return landed != _ON_GROUND
    if info is None or info.high_latency:
        return None if landed is None else landed != _ON_GROUND
    if _shows_flight(telemetry, info):
        return True
    if telemetry.firmware.HEARTBEAT_SHOWS_IN_AIR:
        return telemetry.firmware.in_air(info)
    return None if landed is None else landed != _ON_GROUND


def _shows_flight(telemetry: Telemetry, info: ComponentInfo) -> bool:
    """Return whether an armed vehicle is so high that with its speed or its throttle it can only fly.

    ArduPilot sends EXTENDED_SYS_STATE on request only, and its heartbeat leaves the flight open in a
    failsafe. A vehicle that hovers needs throttle; a wing may glide. Armed on a hill, it does neither.
    """
    height, hud = telemetry.latest(common.GlobalPositionInt), telemetry.latest(common.VfrHud)
    if not info.armed or height is None or hud is None:
        return False
    ages = telemetry.age(common.GlobalPositionInt), telemetry.age(common.VfrHud)
    if any(age is None or age > _EVIDENCE_AGE for age in ages):
        return False
    fast = max(hud.airspeed, hud.groundspeed) >= _FLIGHT_SPEED
    return height.relative_alt / _MILLI >= _FLIGHT_HEIGHT and (fast or hud.throttle >= _FLIGHT_THROTTLE)


def read_home(telemetry: Telemetry) -> HomePosition | None:
    """Return the position of HOME_POSITION."""
    message = telemetry.latest(common.HomePosition)
    coordinates = None if message is None else location(message.latitude, message.longitude)
    return (
        None
        if message is None or coordinates is None
        else HomePosition(*coordinates, message.altitude / _MILLI)
    )
