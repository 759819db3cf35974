"""The events of simulated PX4 vehicles, and their metadata (libevents schema version 2), in our own words.

Names, ids, levels and arguments are PX4's, and so are the status texts that it sends beside them: an event's
id is the hash of its name, in the namespace of autopilots. The events that hold the results of arming checks
are not among them.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.services.events import LogLevel

if TYPE_CHECKING:
    from collections.abc import Mapping

_COMPONENT: Final = 1
_SUB_ID_MASK: Final = 0xFFFFFF
_FNV_OFFSET, _FNV_PRIME, _FNV_MASK = 0x811C9DC5, 0x01000193, 0xFFFFFFFF
_CRITICAL, _ERROR, _INFO = LogLevel.CRITICAL, LogLevel.ERROR, LogLevel.INFO

#: Values of `arm_disarm_reason_t`, by the reason's text in status texts.
REASONS: Final[Mapping[str, int]] = MappingProxyType(
    {
        "internal command": 3,
        "external command": 4,
        "mission start": 5,
        "landing": 6,
        "auto preflight disarming": 7,
        "failsafe": 14,
    }
)
#: Value for a mode that `navigation_mode_t` does not have.
UNKNOWN_MODE: Final = 255
#: Values of `navigation_mode_t`, by main mode and sub mode.
MODE_NUMBERS: Final[Mapping[tuple[int, int], int]] = MappingProxyType(
    {
        (1, 0): 0,
        (2, 0): 1,
        (3, 0): 2,
        (4, 4): 3,
        (4, 3): 4,
        (4, 5): 5,
        (5, 0): 6,
        (6, 0): 7,
        (7, 0): 8,
        (4, 2): 10,
        (4, 6): 11,
        (3, 1): 14,
        (4, 10): 15,
    }
)
_MODES: Final[Mapping[int, tuple[str, str]]] = MappingProxyType(
    {
        0: ("manual", "Manual"),
        1: ("altctl", "Altitude"),
        2: ("posctl", "Position"),
        3: ("auto_mission", "Mission"),
        4: ("auto_loiter", "Hold"),
        5: ("auto_rtl", "Return"),
        6: ("acro", "Acro"),
        7: ("offboard", "Offboard"),
        8: ("stab", "Stabilized"),
        10: ("auto_takeoff", "Takeoff"),
        11: ("auto_land", "Land"),
        14: ("orbit", "Orbit"),
        15: ("auto_vtol_takeoff", "VTOL Takeoff"),
        UNKNOWN_MODE: ("unknown", "unknown mode"),
    }
)
_REASON_NAMES: Final[Mapping[int, str]] = MappingProxyType(
    {
        3: "command_internal",
        4: "command_external",
        5: "mission_start",
        6: "auto_disarm_land",
        7: "auto_disarm_preflight",
        14: "failsafe",
    }
)


@dataclass(frozen=True, slots=True)
class SimulatedEvent:
    """An event that follows a status text.

    Attributes:
        name: PX4's name of the event.
        status_text: The status text as a regular expression; its groups give the arguments.
        message: The message of the metadata.
        level: The level for ground stations.
        internal_level: The level for logs.
        arguments: Name and type of each argument.
    """

    name: str
    status_text: str
    message: str
    level: LogLevel = _INFO
    internal_level: LogLevel = _INFO
    arguments: tuple[tuple[str, str], ...] = ()

    @property
    def id(self) -> int:
        """The id: the component of the namespace and the lower 24 bits of the name's FNV-1a hash."""
        return _COMPONENT << 24 | fnv1a(self.name) & _SUB_ID_MASK


_REASON: Final = (("reason", "arm_disarm_reason_t"),)
EVENTS: Final[tuple[SimulatedEvent, ...]] = (
    SimulatedEvent("commander_armed_by", "Armed by (?P<reason>.+)", "Armed, reason: {1}", arguments=_REASON),
    SimulatedEvent(
        "commander_disarmed_by", "Disarmed by (?P<reason>.+)", "Disarmed, reason: {1}", arguments=_REASON
    ),
    SimulatedEvent(
        "commander_arm_denied_calibrating",
        "Arming denied: calibrating",
        "Arming refused while a sensor is calibrated",
        _CRITICAL,
    ),
    SimulatedEvent(
        "commander_arm_denied_resolve_failures",
        "Arming denied: Resolve system health failures first",
        "Arming refused until the failed checks pass",
        _CRITICAL,
    ),
    SimulatedEvent(
        "commander_disarm_denied_not_landed",
        "Disarming denied: not landed",
        "Disarming refused in the air",
        _CRITICAL,
    ),
    SimulatedEvent(
        "commander_unsupported_arm_disarm_param",
        "Unsupported ARM_DISARM param: (?P<value>.+)",
        "The arming command has the unknown first parameter {1:.3}",
        _ERROR,
        _ERROR,
        (("value", "float"),),
    ),
    SimulatedEvent(
        "commander_modeswitch_not_avail",
        "Switching to (?P<mode>.+) is currently not available",
        "The mode {2} cannot be entered now",
        _CRITICAL,
        arguments=(("custom_mode", "uint32_t"), ("mode", "navigation_mode_t")),
    ),
    SimulatedEvent(
        "commander_unsupported_auto_mode",
        "Unsupported auto mode",
        "The requested automatic mode does not exist",
        _ERROR,
        _ERROR,
    ),
    SimulatedEvent("commander_rtl", "Returning to launch", "The vehicle returns"),
    SimulatedEvent("commander_landing_current_pos", "Landing at current position", "The vehicle lands here"),
    SimulatedEvent("commander_takeoff_detected", "Takeoff detected", "The vehicle has taken off"),
    SimulatedEvent("commander_landing_detected", "Landing detected", "The vehicle has landed"),
)


@cache
def event_metadata() -> bytes:
    """Return the metadata file of the events, not compressed."""
    events = {
        str(event.id & _SUB_ID_MASK): {
            "name": event.name,
            "message": event.message,
            "arguments": [{"name": name, "type": type_name} for name, type_name in event.arguments],
        }
        for event in EVENTS
    }
    reasons = {number: (_REASON_NAMES[number], text) for text, number in REASONS.items()}
    component = {
        "namespace": "px4",
        "enums": {"arm_disarm_reason_t": _enum(reasons), "navigation_mode_t": _enum(_MODES)},
        "event_groups": {"default": {"events": events}},
    }
    return json.dumps({"version": 2, "components": {str(_COMPONENT): component}}).encode()


def _enum(entries: Mapping[int, tuple[str, str]]) -> dict[str, object]:
    described = {str(value): {"name": name, "description": text} for value, (name, text) in entries.items()}
    return {"type": "uint8_t", "entries": described}


def fnv1a(name: str) -> int:
    """Return the FNV-1a hash of a name, 32 bits."""
    found = _FNV_OFFSET
    for byte in name.encode():
        found = (found ^ byte) * _FNV_PRIME & _FNV_MASK
    return found
