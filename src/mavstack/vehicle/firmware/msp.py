"""Betaflight and iNav, which speak MSP: a bridge makes them MAVLink vehicles (`mavstack.bridges.msp`).

Their pilot flies them by radio control. They have flight modes, and iNav flies missions, but neither has
commands such as takeoff; those calls raise `ActionUnsupported`. The names of their modes are those of the
firmware. Where the receiver of the flight controller takes its channels by MSP, the bridge arms it and
switches its modes; else the transmitter does, and the vehicle refuses both.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import common
from mavstack.vehicle.firmware.firmware import Firmware
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.services.version import AutopilotVersion

_STANDARD: Final = common.MavStandardMode
#: The board identifier of simulated flight controllers.
_SIMULATED: Final = b"SITL"

_LACKING: Final[Mapping[str, str]] = MappingProxyType(
    {
        "takeoff": "take off",
        "land": "land",
        "goto": "go to a location",
        "orbit": "orbit",
        "turn": "turn",
        "guided": "follow setpoints",
        "speed": "set its speed",
        "home": "set its home position",
        "fence": "transfer a geofence",
        "rally": "transfer rally points",
        "ftp": "transfer files",
        "logs": "transfer logs",
        "shell": "open a shell",
        "terrain": "use terrain data",
        "roi": "look at a location",
        "servo": "set a servo",
        "relay": "switch a relay",
        "actuator": "set an actuator",
        "motor test": "test a motor",
        "gripper": "use a gripper",
        "winch": "use a winch",
        "ekf sources": "change the sources of its estimator",
        "wind": "take a wind",
        "transition": "change between hovering and flying on a wing",
    }
)
_FEATURES: Final[Mapping[str, bool]] = MappingProxyType(
    {"parameters": True, "flashing": True}
    | dict.fromkeys(("mission", "fence", "rally", "ftp", "logs", "shell", "events", "terrain"), False)
    | dict.fromkeys(("setpoints", "attitude_setpoints", "servos", "relays", "actuators", "failures"), False)
    | dict.fromkeys(("motor_test", "manual_control", "gripper", "winch", "ekf_sources", "vtol"), False)
)


class MspFirmware(Firmware):
    """A vehicle that speaks MSP."""

    FEATURES: ClassVar[Mapping[str, bool]] = _FEATURES
    EQUIPMENT_PARAMETERS: ClassVar[Mapping[str, tuple[str, ...]]] = MappingProxyType(
        {"osd": ("MSP_HAS_OSD",), "vtx": ("MSP_HAS_VTX",)}
    )
    LACKING: ClassVar[Mapping[str, str]] = _LACKING
    #: All reasons that prevent arming are sent in one run, when they change and every half minute.
    PREARM_RUN: ClassVar[float] = 3.0
    PREARM_LIFETIME: ClassVar[float] = 40.0

    @staticmethod
    def has_bootloader(version: AutopilotVersion) -> bool:
        return version.operating_system_custom.rstrip(b"\0") != _SIMULATED

    async def rtl(self) -> None:
        await self.changes.set_standard_mode(_STANDARD.SAFE_RECOVERY)


class Betaflight(MspFirmware):
    """A vehicle that runs Betaflight."""

    NAME: ClassVar[str] = "Betaflight"
    MODES: ClassVar[Mapping[str, frozenset[str]]] = MappingProxyType({"rtl": frozenset({"gps rescue"})})
    LANDING_MODES: ClassVar[frozenset[str]] = frozenset({"gps rescue"})
    SELF_STARTING_MODES: ClassVar[Mapping[VehicleType, frozenset[str]]] = MappingProxyType(
        dict.fromkeys(VehicleType, frozenset({"gps rescue"}))
    )
    LACKING: ClassVar[Mapping[str, str]] = MappingProxyType({**_LACKING, "mission": "fly missions"})


class Inav(MspFirmware):
    """A vehicle that runs iNav."""

    NAME: ClassVar[str] = "iNav"
    MODES: ClassVar[Mapping[str, frozenset[str]]] = MappingProxyType(
        {"rtl": frozenset({"nav rth"}), "mission": frozenset({"nav wp", "nav rth"})}
    )
    LANDING_MODES: ClassVar[frozenset[str]] = frozenset({"nav rth"})
    SELF_STARTING_MODES: ClassVar[Mapping[VehicleType, frozenset[str]]] = MappingProxyType(
        dict.fromkeys(VehicleType, frozenset({"nav wp", "nav rth", "nav launch"}))
    )
    FEATURES: ClassVar[Mapping[str, bool]] = MappingProxyType({**_FEATURES, "mission": True})
