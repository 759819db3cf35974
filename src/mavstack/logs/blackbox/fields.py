"""The meaning of well-known fields: units, multipliers and named values.

The file has no units. Those here are of Betaflight; fields whose unit depends on an older firmware have none.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.logs.blackbox.events import EVENTS
from mavstack.logs.schema import EnumSchema, FieldSchema

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mavstack.logs.blackbox.header import FlightHeader
    from mavstack.logs.schema import DType

_STATES: Final = ("GPS_FIX_HOME", "GPS_FIX", "CALIBRATE_MAG", "SMALL_ANGLE", "FIXED_WING")
_PHASES: Final = ("IDLE", "RX_LOSS_DETECTED", "LANDING", "LANDED", "RX_LOSS_MONITORING", "RX_LOSS_RECOVERED")
#: Flight modes by bit, of Betaflight 4.0 and 4.5.
_MODES_4_0_NAMES = """
    ARM ANGLE HORIZON MAG HEADFREE PASSTHRU FAILSAFE GPSRESCUE ANTIGRAVITY HEADADJ CAMSTAB BEEPER LEDLOW
    CALIB OSD TELEMETRY SERVO1 SERVO2 SERVO3 BLACKBOX AIRMODE 3D FPVANGLEMIX BLACKBOXERASE CAMERA1
    CAMERA2 CAMERA3 FLIPOVERAFTERCRASH PREARM BEEPGPSCOUNT VTXPITMODE USER1
    """
_MODES_4_0: Final = tuple(_MODES_4_0_NAMES.split())
_MODES_4_5_NAMES = """
    ARM ANGLE HORIZON MAG ALTHOLD HEADFREE CHIRP PASSTHRU FAILSAFE POSHOLD GPSRESCUE ANTIGRAVITY HEADADJ
    CAMSTAB BEEPER LEDLOW CALIB OSD TELEMETRY SERVO1 SERVO2 SERVO3 BLACKBOX AIRMODE 3D FPVANGLEMIX
    BLACKBOXERASE CAMERA1 CAMERA2 CAMERA3 FLIPOVERAFTERCRASH PREARM
    """
_MODES_4_5: Final = tuple(_MODES_4_5_NAMES.split())
#: Unit and multiplier of fields that do not depend on the settings.
_UNITS: Final[Mapping[str, tuple[str, float]]] = MappingProxyType(
    {
        "time": ("us", 1.0),
        "rssi": ("%", 100 / 1024),
        "GPS_coord[0]": ("deg", 1e-7),
        "GPS_coord[1]": ("deg", 1e-7),
        "GPS_home[0]": ("deg", 1e-7),
        "GPS_home[1]": ("deg", 1e-7),
        "GPS_speed": ("m/s", 0.01),
        "GPS_velned": ("m/s", 0.01),
        "GPS_ground_course": ("deg", 0.1),
    }
)
_DESCRIPTIONS: Final = {
    "_time": "Time in UTC, if the clock of the flight controller was set",
    "_instance": "Number of the flight in the file",
    "time": "Time since boot",
    "value": "DISARM: reason; FLIGHT_MODE: flags; LOGGING_RESUME: iteration; INFLIGHT_ADJUSTMENT: function",
    "detail": "FLIGHT_MODE: flags before; INFLIGHT_ADJUSTMENT: new value",
}


def flight_modes(header: FlightHeader) -> EnumSchema | None:
    """Return the flight modes of a firmware, or None if their numbers are not known."""
    name, version = header.firmware
    if name != "Betaflight" or version < (4, 0):
        return None
    names = list(_MODES_4_5 if version >= (4, 5) else _MODES_4_0)
    if version >= (2026, 6):
        names.insert(names.index("GPSRESCUE") + 1, "AUTOPILOT")
    return _flags("flight_mode", names)


def field_schema(name: str, dtype: DType, header: FlightHeader) -> FieldSchema:
    """Return the meaning of a field.

    Args:
        name: Name of the column.
        dtype: Its type.
        header: The header of the flight.
    """
    unit, multiplier = _unit(name, header)
    return FieldSchema(
        name,
        dtype,
        unit=unit,
        multiplier=multiplier,
        enum=_enum(name, header),
        description=_DESCRIPTIONS.get(name, ""),
    )


def _unit(name: str, header: FlightHeader) -> tuple[str, float]:
    if name in _UNITS:
        return _UNITS[name]
    firmware, version = header.firmware
    is_betaflight = firmware == "Betaflight"
    resolution = 10 if header.number("blackbox_high_resolution", 0) else 1
    if name in ("gyroADC", "gyroUnfilt") and header.gyro_scale is not None:
        return "deg/s", header.gyro_scale / resolution
    if name == "accSmooth" and header.number("acc_1G", 0) > 1:
        return "g", 1 / header.number("acc_1G", 1)
    if name == "vbatLatest" and is_betaflight and version >= (3, 1):
        return "V", 0.01 if version >= (4, 0) else 0.1
    if name == "amperageLatest" and is_betaflight and version >= (3, 1):
        return "A", 0.01
    if name == "eRPM" and header.number("motor_poles", 0) > 1:
        return "rpm", 200 / header.number("motor_poles", 2)
    if name in ("baroAlt", "BaroAlt"):
        return "m", 0.01
    return ("m", 0.1 if is_betaflight else 1.0) if name == "GPS_altitude" else ("", 1.0)


def _enum(name: str, header: FlightHeader) -> EnumSchema | None:
    if name == "event":
        return EnumSchema("event", EVENTS)
    if name == "flightModeFlags":
        return flight_modes(header)
    if name == "stateFlags":
        return _flags("state", _STATES)
    return EnumSchema("failsafe_phase", dict(enumerate(_PHASES))) if name == "failsafePhase" else None


def _flags(name: str, names: Sequence[str]) -> EnumSchema:
    return EnumSchema(name, {1 << bit: flag for bit, flag in enumerate(names)}, bitmask=True)
