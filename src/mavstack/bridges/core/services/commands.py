"""Services of commands: arming, takeoff, modes, home, rates and any MAV_CMD."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.mode_texts import mode_of_text, mode_text
from mavstack.bridges.core.row import Handler, Service
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.security.roles import Role
from mavstack.services.modes import mode_number
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle

Fields = dict[str, Any]
_CMD: Final = common.MavCmd
_ACCEPTED: Final = int(common.MavResult.ACCEPTED)
_SUCCESS: Final = {"success": True, "result": _ACCEPTED}
_ANGLE_SCALE: Final = 1e7
_CUSTOM: Final = int(common.MavModeFlag.CUSTOM_MODE_ENABLED)
_ARMED: Final = int(common.MavModeFlag.SAFETY_ARMED)
_PX4_MAIN_SHIFT, _PX4_SUB_SHIFT, _BYTE = 16, 24, 0xFF
_HEARTBEAT, _VERSION = 1, 2
_HEARTBEAT_FIELDS: Final = ("autopilot", "type", "system_status", "base_mode", "custom_mode")
_VERSION_FIELDS: Final = (
    "capabilities",
    "flight_sw_version",
    "middleware_sw_version",
    "os_sw_version",
    "board_version",
    "vendor_id",
    "product_id",
    "uid",
)


async def _command(vehicle: Vehicle, command: int, *params: float) -> Fields:
    result = await vehicle.command(command, *params)
    return {"success": True, "result": int(result.result)}


async def arming(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Arm or disarm (mavros_msgs/CommandBool)."""
    try:
        return await _command(vehicle, _CMD.COMPONENT_ARM_DISARM, float(request["value"]))
    except Exception as error:
        if (rename := getattr(error, "rename", None)) is not None:
            rename("arming" if request["value"] else "disarming")
        raise


async def takeoff(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Take off (mavros_msgs/CommandTOL); a location of 0, 0 is the present one."""
    return await _takeoff_or_land(vehicle, _CMD.NAV_TAKEOFF, request)


async def land(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Land (mavros_msgs/CommandTOL); a location of 0, 0 is the present one."""
    return await _takeoff_or_land(vehicle, _CMD.NAV_LAND, request)


async def _takeoff_or_land(vehicle: Vehicle, command: int, request: Fields) -> Fields:
    px4 = vehicle.autopilot == common.MavAutopilot.PX4
    latitude, longitude = request["latitude"], request["longitude"]
    if px4 and latitude == longitude == 0.0:
        latitude = longitude = nan  # the current position; PX4 would fly to 0, 0
    first = request["min_pitch"] if command == _CMD.NAV_TAKEOFF else 0.0
    params = (first, 0.0, 0.0, request["yaw"], latitude, longitude, request["altitude"])
    return await _command(vehicle, command, *params)


async def takeoff_local(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Take off in the local frame (mavros_msgs/CommandTOLLocal), ENU."""
    place = request["position"]
    params = (request["min_pitch"], 0.0, request["rate"], request["yaw"], place["y"], place["x"], -place["z"])
    return await _command(vehicle, _CMD.NAV_TAKEOFF_LOCAL, *params)


async def land_local(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Land in the local frame (mavros_msgs/CommandTOLLocal), ENU."""
    place = request["position"]
    params = (0.0, request["offset"], request["rate"], request["yaw"], place["y"], place["x"], -place["z"])
    return await _command(vehicle, _CMD.NAV_LAND_LOCAL, *params)


async def command_long(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Send any command (mavros_msgs/CommandLong)."""
    params = [request[f"param{number}"] for number in range(1, 8)]
    if request["broadcast"]:
        values = {f"param{number}": value for number, value in enumerate(params, 1)}
        vehicle.connection.send(common.CommandLong(command=request["command"], **values))
        return _SUCCESS
    return await _command(vehicle, request["command"], *params)


async def command_int(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Send any command with a frame (mavros_msgs/CommandInt); x and y are 1e7 degrees or 1e4 metres."""
    target = {} if request["broadcast"] else dict(zip(_TARGET, vehicle.address, strict=True))
    values = {name: request[name] for name in ("param1", "param2", "param3", "param4", "x", "y", "z")}
    message = common.CommandInt(
        **target,
        frame=request["frame"],
        command=request["command"],
        current=request["current"],
        autocontinue=request["autocontinue"],
        **values,
    )
    if request["broadcast"]:
        vehicle.connection.send(message)
        return {"success": True}
    location = message.x / _ANGLE_SCALE, message.y / _ANGLE_SCALE
    params = (*(values[f"param{number}"] for number in range(1, 5)), *location, values["z"])
    await vehicle.command(request["command"], *params, frame=request["frame"])
    return {"success": True}


_TARGET: Final = ("target_system", "target_component")


async def set_home(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Set home (mavros_msgs/CommandHome)."""
    place = (request["yaw"], request["latitude"], request["longitude"], request["altitude"])
    return await _command(vehicle, _CMD.DO_SET_HOME, float(request["current_gps"]), 0.0, 0.0, *place)


async def trigger_control(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Enable the trigger of cameras (mavros_msgs/CommandTriggerControl)."""
    params = (request["trigger_enable"], request["sequence_reset"], request["trigger_pause"])
    return await _command(vehicle, _CMD.DO_TRIGGER_CONTROL, *map(float, params))


async def trigger_interval(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Set the interval of the trigger (mavros_msgs/CommandTriggerInterval)."""
    params = request["cycle_time"], request["integration_time"]
    return await _command(vehicle, _CMD.DO_SET_CAM_TRIGG_INTERVAL, *params)


async def vtol_transition(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Change between hovering and the wing (mavros_msgs/CommandVtolTransition)."""
    return await _command(vehicle, _CMD.DO_VTOL_TRANSITION, float(request["state"]))


async def set_mode(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Set the mode by its name or number (mavros_msgs/SetMode)."""
    text = request["custom_mode"]
    if not text:
        await vehicle.command(_CMD.DO_SET_MODE, float(request["base_mode"]))
        return {"mode_sent": True}
    number = int(text) if text.isdecimal() else _number_of(vehicle, text)
    if number is None:
        await vehicle.set_mode(mode_of_text(text))  # only the vehicle knows the number of this mode
        return {"mode_sent": True}
    base = float(_CUSTOM | (_ARMED if vehicle.armed else 0))
    if vehicle.autopilot == common.MavAutopilot.PX4:
        main, sub = number >> _PX4_MAIN_SHIFT & _BYTE, number >> _PX4_SUB_SHIFT & _BYTE
        params: tuple[float, ...] = (base, main, sub)
    else:
        params = (base, number)
    await with_status_texts(vehicle, vehicle.component.command(_CMD.DO_SET_MODE, *params))
    return {"mode_sent": True}


def _number_of(vehicle: Vehicle, text: str) -> int | None:
    info = vehicle.info
    return None if info is None else mode_number(info.autopilot, info.type, mode_of_text(text))


async def set_stream_rate(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Request a stream at a rate (mavros_msgs/StreamRate)."""
    vehicle.component.send(
        common.RequestDataStream(
            target_system=0,
            target_component=0,
            req_stream_id=request["stream_id"],
            req_message_rate=request["message_rate"],
            start_stop=int(request["on_off"]),
        )
    )
    return {}


async def set_message_interval(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Request a message at a rate in hertz (mavros_msgs/MessageInterval); 0: its default rate."""
    rate = request["message_rate"]
    interval = 0.0 if rate == 0 else -1.0 if rate < 0 else 1e6 / rate
    await vehicle.command(_CMD.SET_MESSAGE_INTERVAL, float(request["message_id"]), interval)
    return {"success": True}


async def home_update(vehicle: Vehicle, _request: Fields, _context: Any) -> Fields:
    """Request HOME_POSITION (std_srvs/Trigger)."""
    await with_status_texts(vehicle, vehicle.component.request_message(common.HomePosition))
    return {"success": True}


async def vehicle_info(vehicle: Vehicle, request: Fields, _context: Any) -> Fields:
    """Return identity and versions of the vehicle (mavros_msgs/VehicleInfoGet)."""
    asked = request["sysid"], request["compid"]
    if not request["get_all"] and asked not in ((0, 0), tuple(vehicle.address)):
        raise InvalidArgumentError(f"the vehicle is {vehicle.address}, not {asked[0]}/{asked[1]}")
    heartbeat = vehicle.latest(common.Heartbeat)
    version = vehicle.latest(common.AutopilotVersion)
    if version is None:
        await vehicle.get_version()
        version = vehicle.latest(common.AutopilotVersion)
    found: Fields = {"sysid": vehicle.address.system, "compid": vehicle.address.component}
    if heartbeat is not None:
        found |= {name: getattr(heartbeat, name) for name in _HEARTBEAT_FIELDS}
        found |= {"mode": mode_text(heartbeat), "mode_id": heartbeat.custom_mode}
        found["available_info"] = _HEARTBEAT
    if version is not None:
        found |= {name: getattr(version, name) for name in _VERSION_FIELDS}
        found["flight_custom_version"] = bytes(version.flight_custom_version).hex()
        found["available_info"] = found.get("available_info", 0) | _VERSION
    return {"success": True, "vehicles": [found]}


async def arm(vehicle: Vehicle, _request: Fields, _context: Any) -> Fields:
    """Arm, and wait until the vehicle is armed (std_srvs/Trigger)."""
    await vehicle.arm()
    return {"success": True}


async def disarm(vehicle: Vehicle, _request: Fields, _context: Any) -> Fields:
    """Disarm, and wait until the vehicle is disarmed (std_srvs/Trigger)."""
    await vehicle.disarm()
    return {"success": True}


async def hold(vehicle: Vehicle, _request: Fields, _context: Any) -> Fields:
    """Hold the present position (std_srvs/Trigger)."""
    await vehicle.hold()
    return {"success": True}


async def rtl(vehicle: Vehicle, _request: Fields, _context: Any) -> Fields:
    """Return to launch, without waiting for the arrival (std_srvs/Trigger)."""
    await vehicle.rtl(wait=False)
    return {"success": True}


def _row(
    name: str,
    kind: str,
    handle: Handler,
    meaning: str,
    role: Role = Role.OPERATE,
    difference: str = "",
    required: tuple[str, ...] = (),
    required_unless: str = "",
) -> Service:
    full = kind if "/" in kind else f"mavros_msgs/srv/{kind}"
    return Service(name, full, handle, role, meaning, difference, required, required_unless)


_TRIGGER: Final = "std_srvs/srv/Trigger"
_OURS: Final = "not in MAVROS; the message has the vehicle's reason"

ROWS: Final = (
    _row("cmd/arming", "CommandBool", arming, "COMPONENT_ARM_DISARM", required=("value",)),
    _row("cmd/takeoff", "CommandTOL", takeoff, "NAV_TAKEOFF", required=("altitude",)),
    _row("cmd/land", "CommandTOL", land, "NAV_LAND"),
    _row("cmd/takeoff_local", "CommandTOLLocal", takeoff_local, "NAV_TAKEOFF_LOCAL", required=("position",)),
    _row("cmd/land_local", "CommandTOLLocal", land_local, "NAV_LAND_LOCAL", required=("position",)),
    _row("cmd/command", "CommandLong", command_long, "any MAV_CMD", Role.ADMINISTER),
    _row("cmd/command_int", "CommandInt", command_int, "any MAV_CMD", Role.ADMINISTER),
    _row(
        "cmd/set_home",
        "CommandHome",
        set_home,
        "DO_SET_HOME",
        required=("current_gps", "latitude", "longitude", "altitude"),
        required_unless="current_gps",
    ),
    _row(
        "cmd/trigger_control",
        "CommandTriggerControl",
        trigger_control,
        "DO_TRIGGER_CONTROL",
        required=("trigger_enable",),
    ),
    _row("cmd/trigger_interval", "CommandTriggerInterval", trigger_interval, "DO_SET_CAM_TRIGG_INTERVAL"),
    _row("cmd/vtol_transition", "CommandVtolTransition", vtol_transition, "DO_VTOL_TRANSITION"),
    _row(
        "set_mode",
        "SetMode",
        set_mode,
        "DO_SET_MODE",
        difference="mode_sent is the vehicle's answer, not the fact that a message was sent",
    ),
    _row(
        "set_stream_rate",
        "StreamRate",
        set_stream_rate,
        "REQUEST_DATA_STREAM",
        Role.OBSERVE,
        required=("stream_id", "message_rate", "on_off"),
    ),
    _row(
        "set_message_interval", "MessageInterval", set_message_interval, "SET_MESSAGE_INTERVAL", Role.OBSERVE
    ),
    _row("vehicle_info_get", "VehicleInfoGet", vehicle_info, "AUTOPILOT_VERSION", Role.OBSERVE),
    _row("home_position/req_update", _TRIGGER, home_update, "HOME_POSITION", Role.OBSERVE),
    _row("arm", _TRIGGER, arm, "Vehicle.arm", difference=_OURS),
    _row("disarm", _TRIGGER, disarm, "Vehicle.disarm", difference=_OURS),
    _row("hold", _TRIGGER, hold, "Vehicle.hold", difference=_OURS),
    _row("rtl", _TRIGGER, rtl, "Vehicle.rtl", difference=_OURS),
)
