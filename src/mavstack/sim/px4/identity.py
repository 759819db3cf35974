"""PX4's identity: versions, capabilities, board."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.version import AutopilotVersion, FirmwareVersion

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle

VERSION: Final = FirmwareVersion(1, 16, 0)
OPERATING_SYSTEM: Final = FirmwareVersion(6, 6, 0)
#: An invented commit hash, because this is not a build of PX4.
GIT_HASH: Final = "4d61767374616b00"
HARDWARE: Final = "MAVSTACK_SIM"
_BOARD: Final = 1
#: USB ids that a vehicle with a simulated board (`board_id`) reports.
_USB_VENDOR, _USB_PRODUCT = 0x26AC, 0x0032

_CAPABILITY = common.MavProtocolCapability
CAPABILITIES: Final = int(
    _CAPABILITY.MISSION_FLOAT
    | _CAPABILITY.PARAM_FLOAT
    | _CAPABILITY.MISSION_INT
    | _CAPABILITY.COMMAND_INT
    | _CAPABILITY.PARAM_ENCODE_BYTEWISE
    | _CAPABILITY.FTP
    | _CAPABILITY.SET_ATTITUDE_TARGET
    | _CAPABILITY.SET_POSITION_TARGET_LOCAL_NED
    | _CAPABILITY.FLIGHT_TERMINATION
    | _CAPABILITY.MAVLINK2
    | _CAPABILITY.MISSION_FENCE
    | _CAPABILITY.MISSION_RALLY
)


def version_of(vehicle: SimulatedVehicle) -> AutopilotVersion:
    """Return the content of AUTOPILOT_VERSION."""
    serial = vehicle.serial
    commit = bytes.fromhex(GIT_HASH)[::-1]
    return AutopilotVersion(
        capabilities=CAPABILITIES,
        flight=VERSION,
        middleware=VERSION,
        operating_system=OPERATING_SYSTEM,
        vendor_id=0 if vehicle.board_id is None else _USB_VENDOR,
        product_id=0 if vehicle.board_id is None else _USB_PRODUCT,
        board_version=_BOARD,
        uid=int.from_bytes(serial, "big"),
        uid2=serial.rjust(18, b"\0"),
        flight_custom=commit,
        middleware_custom=commit,
    )
