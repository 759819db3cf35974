"""Flight modes: names, setting, listing, and the mode server (guide: standard modes)."""

from mavstack.services.modes.available import AvailableMode
from mavstack.services.modes.client import ListModes, SetMode, SetStandardMode, name_in
from mavstack.services.modes.monitor import ModeMonitor, ModeSeen, ModesOutdated
from mavstack.services.modes.names import (
    is_placeholder,
    listed_name,
    mode_name,
    mode_names,
    mode_number,
    px4_custom_mode,
    px4_modes_of,
)
from mavstack.services.modes.server import ModeChanged, ModeRefused, ModeServer, modes_of

__all__ = [
    "AvailableMode",
    "ListModes",
    "ModeChanged",
    "ModeMonitor",
    "ModeRefused",
    "ModeSeen",
    "ModeServer",
    "ModesOutdated",
    "SetMode",
    "SetStandardMode",
    "is_placeholder",
    "listed_name",
    "mode_name",
    "mode_names",
    "mode_number",
    "modes_of",
    "name_in",
    "px4_custom_mode",
    "px4_modes_of",
]
