"""Who is on a link, in words: what a HEARTBEAT says of its sender's kind, autopilot, mode and state.

ArduPilot's modes are enums of its dialect, one a kind of vehicle. PX4 has its own numbers, in the two upper
bytes of `custom_mode`: a main mode, and for its AUTO mode what it does automatically.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Dialect
    from mavstack.wire import Packet

_ARDUPILOT: Final = 3
_PX4: Final = 12
_NO_AUTOPILOT: Final = 8
_CUSTOM_MODE: Final = 1
_ARMED: Final = 128

_AUTOPILOTS: Final[Mapping[int, str]] = MappingProxyType(
    {_ARDUPILOT: "ArduPilot", _PX4: "PX4", _NO_AUTOPILOT: ""}
)
_ABBREVIATIONS: Final = frozenset({"GCS", "ADSB", "VTOL", "GPS", "IMU", "ODID", "OSD", "FLARM"})
_MODE_ENUMS: Final[Mapping[str, frozenset[int]]] = MappingProxyType(
    {
        "COPTER_MODE": frozenset({2, 3, 4, 13, 14, 15, 29, 35, 43}),
        "PLANE_MODE": frozenset({1, 19, 20, 21, 22, 23, 24, 25}),
        "ROVER_MODE": frozenset({10, 11}),
        "SUB_MODE": frozenset({12}),
        "TRACKER_MODE": frozenset({5}),
    }
)
_PX4_AUTO: Final = 4
_PX4_MODES: Final[Mapping[int, str]] = MappingProxyType(
    {
        1: "MANUAL",
        2: "ALTCTL",
        3: "POSCTL",
        4: "AUTO",
        5: "ACRO",
        6: "OFFBOARD",
        7: "STABILIZED",
        8: "RATTITUDE",
        10: "TERMINATION",
    }
)
_PX4_AUTO_MODES: Final[Mapping[int, str]] = MappingProxyType(
    {
        1: "READY",
        2: "TAKEOFF",
        3: "LOITER",
        4: "MISSION",
        5: "RTL",
        6: "LAND",
        8: "FOLLOW_TARGET",
        9: "PRECLAND",
        10: "VTOL_TAKEOFF",
    }
)


class Identity(NamedTuple):
    """One component of one system, in words; empty where nothing is known."""

    kind: str
    autopilot: str = ""
    mode: str = ""
    armed: bool | None = None
    state: str = ""


def identify(component: int, heartbeat: Packet | None, dialect: Dialect) -> Identity:
    """What is known of a component, from its last HEARTBEAT if it sent one."""
    message = heartbeat.message if heartbeat is not None and heartbeat.name == "HEARTBEAT" else None
    if message is None:
        return Identity(words(_entry(dialect, "MAV_COMPONENT", component) or ""))
    autopilot = int(message.autopilot)
    state = words(getattr(message.system_status, "name", ""))
    if autopilot == _NO_AUTOPILOT:
        return Identity(words(_name(message.type)), "", "", None, state)
    armed = bool(message.base_mode & _ARMED)
    name = _AUTOPILOTS.get(autopilot) or words(_name(message.autopilot))
    return Identity(words(_name(message.type)), name, mode_name(message, dialect), armed, state)


def mode_name(heartbeat: object, dialect: Dialect) -> str:
    """The flight mode that a HEARTBEAT tells, as its autopilot calls it."""
    custom = int(getattr(heartbeat, "custom_mode", 0))
    if not int(getattr(heartbeat, "base_mode", 0)) & _CUSTOM_MODE:
        return ""
    autopilot, kind = int(getattr(heartbeat, "autopilot", 0)), int(getattr(heartbeat, "type", 0))
    if autopilot == _PX4:
        main, detail = custom >> 16 & 0xFF, custom >> 24
        name = _PX4_AUTO_MODES.get(detail) if main == _PX4_AUTO else None
        return name or _PX4_MODES.get(main, f"mode {custom}")
    if autopilot == _ARDUPILOT:
        enum = next((name for name, kinds in _MODE_ENUMS.items() if kind in kinds), "")
        return _entry(dialect, enum, custom) or f"mode {custom}"
    return f"mode {custom}"


def words(name: str) -> str:
    """An enum entry's name as words: `GROUND_ROVER` is `ground rover`."""
    return " ".join(word if word in _ABBREVIATIONS else word.lower() for word in name.split("_"))


def _entry(dialect: Dialect, enum: str, value: int) -> str | None:
    if enum not in dialect.enums:
        return None
    return next((member.name for member in dialect.enums[enum] if member.value == value), None)


def _name(value: int) -> str:
    """The name of an enum value, or its number if it has none."""
    return str(getattr(value, "name", int(value)))
