"""The identity of a component in words, from its HEARTBEAT: type, autopilot, flight mode, armed, state."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.services.modes import name_in

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Dialect, common
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


class Identity(NamedTuple):
    """A component of a system in words; an unknown part is empty."""

    type_name: str
    autopilot: str = ""
    mode: str = ""
    armed: bool | None = None
    state: str = ""


def identify(component: int, heartbeat: Packet | None, dialect: Dialect) -> Identity:
    """Return the identity of a component from its last HEARTBEAT, or from its id if it sent none."""
    message = heartbeat.message if heartbeat is not None and heartbeat.name == "HEARTBEAT" else None
    if message is None:
        return Identity(entry_words(_entry(dialect, "MAV_COMPONENT", component) or ""))
    autopilot = int(message.autopilot)
    state = entry_words(getattr(message.system_status, "name", ""))
    if autopilot == _NO_AUTOPILOT:
        return Identity(entry_words(_name(message.type)), "", "", None, state)
    armed = bool(message.base_mode & _ARMED)
    name = _AUTOPILOTS.get(autopilot) or entry_words(_name(message.autopilot))
    return Identity(entry_words(_name(message.type)), name, mode_name(message), armed, state)


def mode_name(heartbeat: common.Heartbeat) -> str:
    """Return the flight mode of a HEARTBEAT, as its autopilot calls it; empty if it has none."""
    return name_in(heartbeat) if int(heartbeat.base_mode) & _CUSTOM_MODE else ""


def entry_words(name: str) -> str:
    """Return the name of an enum entry as words: `GROUND_ROVER` is `ground rover`."""
    return " ".join(word if word in _ABBREVIATIONS else word.lower() for word in name.split("_"))


def _entry(dialect: Dialect, enum: str, value: int) -> str | None:
    if enum not in dialect.enums:
        return None
    return next((member.name for member in dialect.enums[enum] if member.value == value), None)


def _name(value: int) -> str:
    """Return the name of an enum value, or its number if it has none."""
    return str(getattr(value, "name", int(value)))
