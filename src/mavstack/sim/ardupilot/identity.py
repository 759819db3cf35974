"""ArduPilot's identity: versions, capabilities, banner."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.version import AutopilotVersion, FirmwareVersion
from mavstack.sim.ardupilot.terrain import is_enabled
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.sim.vehicle import SimulatedVehicle


VERSION: Final = FirmwareVersion(4, 6, 3)
#: Invented commit hashes, because this is not a build of ArduPilot.
GIT_HASH: Final = "51a17d00"
_OPERATING_SYSTEM_HASH: Final = "51a17c05"
#: The board type that ArduPilot's own simulator reports.
_BOARD: Final = 3
#: USB ids that a vehicle with a simulated board (`board_id`) reports.
_USB_VENDOR, _USB_PRODUCT = 0x1209, 0x5740

_CAPABILITY = common.MavProtocolCapability
_CAPABILITIES: Final = (
    _CAPABILITY.MISSION_FLOAT
    | _CAPABILITY.PARAM_FLOAT
    | _CAPABILITY.MISSION_INT
    | _CAPABILITY.COMMAND_INT
    | _CAPABILITY.FTP
    | _CAPABILITY.SET_POSITION_TARGET_GLOBAL_INT
    | _CAPABILITY.FLIGHT_TERMINATION
    | _CAPABILITY.COMPASS_CALIBRATION
    | _CAPABILITY.MAVLINK2
    | _CAPABILITY.MISSION_FENCE
    | _CAPABILITY.MISSION_RALLY
    | _CAPABILITY.PARAM_ENCODE_C_CAST
    | _CAPABILITY.SET_ATTITUDE_TARGET
)
#: Vehicle types that ignore SET_POSITION_TARGET_LOCAL_NED, because ArduPlane does.
_WINGED: Final = frozenset({VehicleType.PLANE, VehicleType.VTOL})
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


def version_of(vehicle: SimulatedVehicle) -> AutopilotVersion:
    """Return the content of AUTOPILOT_VERSION."""
    serial = vehicle.serial
    terrain = _CAPABILITY.TERRAIN if vehicle.terrain is not None and is_enabled(vehicle) else 0
    local = 0 if vehicle.vehicle_type in _WINGED else _CAPABILITY.SET_POSITION_TARGET_LOCAL_NED
    return AutopilotVersion(
        capabilities=int(_CAPABILITIES | terrain | local),
        flight=vehicle.profile.version,
        vendor_id=0 if vehicle.board_id is None else _USB_VENDOR,
        product_id=0 if vehicle.board_id is None else _USB_PRODUCT,
        board_version=(_BOARD if vehicle.board_id is None else vehicle.board_id) << 16,
        uid=int.from_bytes(serial, "little"),
        uid2=serial.ljust(18, b"\0"),
        flight_custom=GIT_HASH.encode("ascii"),
        operating_system_custom=_OPERATING_SYSTEM_HASH.encode("ascii"),
    )


def banner_of(vehicle: SimulatedVehicle) -> Iterator[str]:
    """Yield the lines that the firmware sends after start-up and on request."""
    yield f"{firmware_name(vehicle.vehicle_type)} V{vehicle.profile.version} ({GIT_HASH})"
    yield f"Mavstack simulation, board {vehicle.address.system:03d}"
    yield "RCOut: PWM:1-16"
    frame = _FRAMES.get(vehicle.vehicle_type)
    if frame is not None:
        yield frame
