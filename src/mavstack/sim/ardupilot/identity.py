"""ArduPilot's identity: versions, capabilities, banner."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.version import AutopilotVersion, FirmwareVersion
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.sim.autopilot.interfaces import Vehicle

VERSION: Final = FirmwareVersion(4, 6, 3)
#: An invented commit hash, because this is not a build of ArduPilot.
GIT_HASH: Final = "51a17d00"
_OPERATING_SYSTEM_HASH: Final = "51a17c05"
#: Board type of simulated hardware.
_BOARD: Final = 3
#: First bytes of the board's unique id; the system id follows.
_SERIAL: Final = bytes.fromhex("4d61767374636b")

_CAN = common.MavProtocolCapability
_CAPABILITIES: Final = (
    _CAN.MISSION_FLOAT
    | _CAN.PARAM_FLOAT
    | _CAN.MISSION_INT
    | _CAN.COMMAND_INT
    | _CAN.FTP
    | _CAN.SET_POSITION_TARGET_LOCAL_NED
    | _CAN.SET_POSITION_TARGET_GLOBAL_INT
    | _CAN.FLIGHT_TERMINATION
    | _CAN.COMPASS_CALIBRATION
    | _CAN.MAVLINK2
    | _CAN.MISSION_FENCE
    | _CAN.MISSION_RALLY
    | _CAN.PARAM_ENCODE_C_CAST
    | _CAN.SET_ATTITUDE_TARGET
)
_FIRMWARES: Final[Mapping[VehicleType, str]] = MappingProxyType(
    {
        VehicleType.COPTER: "ArduCopter",
        VehicleType.PLANE: "ArduPlane",
        VehicleType.VTOL: "ArduPlane",
        VehicleType.ROVER: "ArduRover",
        VehicleType.BOAT: "ArduRover",
        VehicleType.SUB: "ArduSub",
    }
)
_FRAMES: Final[Mapping[VehicleType, str]] = MappingProxyType(
    {
        VehicleType.COPTER: "Frame: QUAD/X",
        VehicleType.VTOL: "QuadPlane initialised, class 1 type 1",
        VehicleType.SUB: "Frame: VECTORED",
    }
)


def firmware_name(vehicle_type: VehicleType) -> str:
    """Return the firmware of a vehicle type."""
    return _FIRMWARES[vehicle_type]


def version_of(vehicle: Vehicle) -> AutopilotVersion:
    """Return the content of AUTOPILOT_VERSION."""
    serial = _SERIAL + bytes([vehicle.address.system])
    return AutopilotVersion(
        capabilities=int(_CAPABILITIES),
        flight=VERSION,
        board_version=_BOARD << 16,
        uid=int.from_bytes(serial, "little"),
        uid2=serial.ljust(18, b"\0"),
        flight_custom=GIT_HASH.encode("ascii"),
        operating_system_custom=_OPERATING_SYSTEM_HASH.encode("ascii"),
    )


def banner_of(vehicle: Vehicle) -> Iterator[str]:
    """Yield the lines that the firmware sends after start-up and on request."""
    yield f"{firmware_name(vehicle.vehicle_type)} V{VERSION} ({GIT_HASH})"
    yield f"Mavstack simulation, board {vehicle.address.system:03d}"
    yield "RCOut: PWM:1-16"
    frame = _FRAMES.get(vehicle.vehicle_type)
    if frame is not None:
        yield frame
