"""The parameters that identify a vehicle, by firmware: one table for all that load or set parameters.

A value of another vehicle in one of them makes two vehicles with one id.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Mapping

#: The parameter that holds the system id, by MAV_AUTOPILOT: the present name first, then earlier names.
SYSTEM_ID_PARAMETERS: Final[Mapping[int, tuple[str, ...]]] = MappingProxyType(
    {
        int(common.MavAutopilot.ARDUPILOTMEGA): ("MAV_SYSID", "SYSID_THISMAV"),
        int(common.MavAutopilot.PX4): ("MAV_SYS_ID",),
    }
)
#: All identity parameters by MAV_AUTOPILOT, as `fnmatch` patterns.
IDENTITY_PARAMETERS: Final[Mapping[int, tuple[str, ...]]] = MappingProxyType(
    {
        int(common.MavAutopilot.ARDUPILOTMEGA): (
            "SYSID_THISMAV",
            "MAV_SYSID",
            "BRD_SERIAL_NUM",
            "CAN_D?_UC_NODE",
        ),
        int(common.MavAutopilot.PX4): ("MAV_SYS_ID", "MAV_COMP_ID", "UAVCAN_NODE_ID"),
    }
)
#: The patterns of all firmwares together.
ALL_IDENTITY_PARAMETERS: Final = tuple(name for names in IDENTITY_PARAMETERS.values() for name in names)
