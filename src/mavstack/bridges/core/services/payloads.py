"""Services of gimbals, mounts and cameras."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.row import Handler, Service
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle

Fields = dict[str, Any]
_CMD: Final = common.MavCmd
_DEVICE_INFORMATION, _MANAGER_INFORMATION = 283, 280
_ROI: Final = (
    _CMD.DO_SET_ROI_LOCATION,
    _CMD.DO_SET_ROI_WPNEXT_OFFSET,
    _CMD.DO_SET_ROI_SYSID,
    _CMD.DO_SET_ROI_NONE,
)
_CONTROLLERS: Final = ("sysid_primary", "compid_primary", "sysid_secondary", "compid_secondary")
_TRACK: Final = (_CMD.CAMERA_TRACK_POINT, _CMD.CAMERA_TRACK_RECTANGLE, _CMD.CAMERA_STOP_TRACKING)


async def _command(vehicle: Vehicle, command: int, *params: float) -> Fields:
    result = await vehicle.command(command, *params)
    return {"success": True, "result": int(result.result)}


async def device_info(vehicle: Vehicle, _request: Fields, _context: Any) -> Fields:
    """Request GIMBAL_DEVICE_INFORMATION (mavros_msgs/GimbalGetInformation)."""
    return await _command(vehicle, _CMD.REQUEST_MESSAGE, _DEVICE_INFORMATION)


async def manager_info(vehicle: Vehicle, _request: Fields, _context: Any) -> Fields:
    """Request GIMBAL_MANAGER_INFORMATION (mavros_msgs/GimbalGetInformation)."""
    return await _command(vehicle, _CMD.REQUEST_MESSAGE, _MANAGER_INFORMATION)


async def configure(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Take or release control (mavros_msgs/GimbalManagerConfigure)."""
    params = [float(request[name]) for name in _CONTROLLERS]
    gimbal = float(request["gimbal_device_id"])
    return await _command(vehicle, _CMD.DO_GIMBAL_MANAGER_CONFIGURE, *params, 0.0, 0.0, gimbal)


async def pitch_yaw(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Point the gimbal (mavros_msgs/GimbalManagerPitchyaw), in degrees as the command has them."""
    params = [request[name] for name in ("pitch", "yaw", "pitch_rate", "yaw_rate")]
    flags, gimbal = float(request["flags"]), float(request["gimbal_device_id"])
    return await _command(vehicle, _CMD.DO_GIMBAL_MANAGER_PITCHYAW, *params, flags, 0.0, gimbal)


async def set_roi(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Set the region of interest (mavros_msgs/GimbalManagerSetRoi)."""
    mode, gimbal = request["mode"], float(request["gimbal_device_id"])
    if mode >= len(_ROI):
        raise InvalidArgumentError(f"mode must be from 0 to 3, got {mode}")
    places = (
        (request["latitude"], request["longitude"], request["altitude"]),
        (request["pitch_offset"], request["roll_offset"], request["yaw_offset"]),
    )
    if mode == 2:
        return await _command(vehicle, _ROI[mode], float(request["sysid"]), gimbal)
    place = places[mode] if mode < len(places) else (0.0, 0.0, 0.0)
    return await _command(vehicle, _ROI[mode], gimbal, 0.0, 0.0, 0.0, *place)


async def track(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Track a point or a rectangle in the picture (mavros_msgs/GimbalManagerCameraTrack)."""
    mode = request["mode"]
    if mode >= len(_TRACK):
        raise InvalidArgumentError(f"mode must be from 0 to 2, got {mode}")
    names = (("x", "y", "radius"), ("top_left_x", "top_left_y", "bottom_right_x", "bottom_right_y"), ())
    return await _command(vehicle, _TRACK[mode], *(request[name] for name in names[mode]))


async def mount_configure(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Configure a mount (mavros_msgs/MountConfigure)."""
    names = ("mode", "stabilize_roll", "stabilize_pitch", "stabilize_yaw", "roll_input", "pitch_input")
    params = [float(request[name]) for name in (*names, "yaw_input")]
    return await _command(vehicle, _CMD.DO_MOUNT_CONFIGURE, *params)


def _row(
    name: str,
    kind: str,
    handle: Handler,
    meaning: str,
    role: Role = Role.OPERATE,
    required: tuple[str, ...] = (),
) -> Service:
    return Service(name, f"mavros_msgs/srv/{kind}", handle, role, meaning, required=required)


_INFORMATION: Final = "GimbalGetInformation"
_PREFIX: Final = "gimbal_control"
ROWS: Final = (
    _row(f"{_PREFIX}/device/get_info", _INFORMATION, device_info, "REQUEST_MESSAGE", Role.OBSERVE),
    _row(f"{_PREFIX}/manager/get_info", _INFORMATION, manager_info, "REQUEST_MESSAGE", Role.OBSERVE),
    _row(
        f"{_PREFIX}/manager/configure",
        "GimbalManagerConfigure",
        configure,
        "DO_GIMBAL_MANAGER_CONFIGURE",
        required=_CONTROLLERS,
    ),
    _row(
        f"{_PREFIX}/manager/pitchyaw",
        "GimbalManagerPitchyaw",
        pitch_yaw,
        "DO_GIMBAL_MANAGER_PITCHYAW",
        required=("pitch", "yaw"),
    ),
    _row(f"{_PREFIX}/manager/set_roi", "GimbalManagerSetRoi", set_roi, "DO_SET_ROI_…", required=("mode",)),
    _row(
        f"{_PREFIX}/manager/camera_track",
        "GimbalManagerCameraTrack",
        track,
        "CAMERA_TRACK_…",
        required=("mode",),
    ),
    _row(
        "mount_control/configure",
        "MountConfigure",
        mount_configure,
        "DO_MOUNT_CONFIGURE",
        required=("mode",),
    ),
)
