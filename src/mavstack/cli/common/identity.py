"""Who is on a link, in words: what a HEARTBEAT says of its sender's kind, autopilot, mode and state."""

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
    return Identity(words(_name(message.type)), name, mode_in(message), armed, state)


def mode_in(heartbeat: common.Heartbeat) -> str:
    """The flight mode that a HEARTBEAT tells, as its autopilot calls it."""
    return name_in(heartbeat) if int(heartbeat.base_mode) & _CUSTOM_MODE else ""


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
