"""Names of flight modes as MAVROS has them: "AUTO.MISSION" for PX4's mission mode, "FBWA" of ArduPlane."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import common
from mavstack.services.modes import mode_names

if TYPE_CHECKING:
    from collections.abc import Mapping

_AUTO: Final = 4
_PREFIX: Final = "AUTO."
#: The MAVROS names of ArduPilot modes, by Mavstack's names.
_ARDUPILOT: Final[Mapping[str, str]] = MappingProxyType(
    {"FLY_BY_WIRE_A": "FBWA", "FLY_BY_WIRE_B": "FBWB", "INITIALIZING": "INITIALISING"}
)


def mode_text(heartbeat: Any) -> str:
    """Return the name of the mode in a HEARTBEAT; "CMODE(n)" for an unknown one."""
    number = heartbeat.custom_mode
    if not heartbeat.base_mode & common.MavModeFlag.CUSTOM_MODE_ENABLED:
        return f"MODE(0x{heartbeat.base_mode:02X})"
    name = mode_names(heartbeat.autopilot, heartbeat.type).get(number)
    if name is None:
        return f"CMODE({number})"
    if heartbeat.autopilot == common.MavAutopilot.PX4:
        return _PREFIX + name if number >> 16 & 0xFF == _AUTO else name
    return _ARDUPILOT.get(name, name)


def mode_of_text(text: str) -> str:
    """Return our name of a mode by its name in MAVROS."""
    return text.strip().removeprefix(_PREFIX)
