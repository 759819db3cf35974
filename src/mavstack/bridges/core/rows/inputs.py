"""Rows of other inputs: sticks, texts, home, devices, payloads, companion computers, Remote ID, tunnels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.frames import ned_enu, to_ros_attitude
from mavstack.bridges.core.inbound import finite, location, quaternion, vector
from mavstack.bridges.core.qos import DEFAULT, NEWEST, PACKETS, SENSOR
from mavstack.bridges.core.row import Subscription
from mavstack.bridges.core.rows.packets import packet_sink
from mavstack.bridges.core.view import to_sea_level
from mavstack.dialects import common
from mavstack.security.roles import Role
from mavstack.services.statustext import chunks_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.bridges.core.inbound import Inbound
    from mavstack.bridges.core.qos import Qos
    from mavstack.dialects import Message

Fields = dict[str, Any]
_TEXT_NUMBERS: Final = 0xFFFF
_TUNE_SIZE: Final = 247
_ID_SIZE: Final = 20
_UAS_SIZE: Final = 20
_DESCRIPTION_SIZE: Final = 23


def status_text(fields: Fields, inbound: Inbound) -> tuple[Message, ...]:
    """Return STATUSTEXT, in chunks, from mavros_msgs/StatusText."""
    number = inbound.next_number("statustext", _TEXT_NUMBERS) + 1
    return tuple(chunks_of(fields["text"], fields["severity"], number))


def override(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return RC_CHANNELS_OVERRIDE from mavros_msgs/OverrideRCIn; 65535 ignores a channel, 0 releases it."""
    channels = {f"chan{number}_raw": value for number, value in enumerate(fields["channels"], 1)}
    return (common.RcChannelsOverride(**inbound.addressed, **channels),)


def manual_control(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return MANUAL_CONTROL from mavros_msgs/ManualControl."""
    axes = ["x", "y", "z", "r", "s", "t", "aux1", "aux2", "aux3", "aux4", "aux5", "aux6"]
    finite(*(fields[name] for name in axes))
    values = {name: round(min(max(fields[name], -1000), 1000)) for name in axes}
    buttons = {name: fields[name] for name in ("buttons", "buttons2", "enabled_extensions")}
    return (common.ManualControl(target=inbound.target.system, **values, **buttons),)


def home(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return SET_HOME_POSITION from mavros_msgs/HomePosition, above the ellipsoid."""
    point = fields["geo"]
    lat, lon = location(point["latitude"], point["longitude"])
    finite(point["altitude"])
    altitude = to_sea_level(point["latitude"], point["longitude"], point["altitude"])
    x, y, z = ned_enu(*vector(fields["position"]))
    approach = ned_enu(*vector(fields["approach"]))
    orientation = fields["orientation"]
    unset = not any(orientation.values())
    q = (1.0, 0.0, 0.0, 0.0) if unset else _attitude(orientation)
    return (
        common.SetHomePosition(
            target_system=inbound.target.system,
            latitude=lat, longitude=lon, altitude=round(altitude * 1000),
            x=x, y=y, z=z, q=q,
            approach_x=approach[0], approach_y=approach[1], approach_z=approach[2],
            time_usec=inbound.microseconds,
        ),
    )  # fmt: skip


def _attitude(fields: Fields) -> tuple[float, float, float, float]:
    x, y, z, w = quaternion(fields)
    x, y, z, w = to_ros_attitude(w, x, y, z)
    return w, x, y, z


def adsb(fields: Fields, _inbound: Inbound) -> tuple[Message]:
    """Return ADSB_VEHICLE from mavros_msgs/ADSBVehicle."""
    lat, lon = location(fields["latitude"], fields["longitude"])
    finite(fields["altitude"], fields["heading"], fields["hor_velocity"], fields["ver_velocity"])
    return (
        common.AdsbVehicle(
            ICAO_address=fields["icao_address"],
            lat=lat,
            lon=lon,
            altitude_type=fields["altitude_type"],
            altitude=round(fields["altitude"] * 1e3),
            heading=round(fields["heading"] * 100),
            hor_velocity=round(fields["hor_velocity"] * 100),
            ver_velocity=round(fields["ver_velocity"] * 100),
            callsign=fields["callsign"][:8],
            emitter_type=fields["emitter_type"],
            tslc=min(max(fields["tslc"]["sec"], 0), 255),
            flags=fields["flags"],
            squawk=fields["squawk"],
        ),
    )


def actuator_controls(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return SET_ACTUATOR_CONTROL_TARGET from mavros_msgs/ActuatorControl."""
    finite(*fields["controls"])
    return (
        common.SetActuatorControlTarget(
            time_usec=inbound.microseconds,
            group_mlx=fields["group_mix"],
            **inbound.addressed,
            controls=fields["controls"],
        ),
    )


def tunnel(fields: Fields, _inbound: Inbound) -> tuple[Message]:
    """Return TUNNEL from mavros_msgs/Tunnel."""
    return (common.Tunnel(**{**fields, "payload": bytes(fields["payload"])}),)


def tune(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return PLAY_TUNE_V2 from mavros_msgs/PlayTuneV2."""
    text = fields["tune"][:_TUNE_SIZE]
    return (common.PlayTuneV2(**inbound.addressed, format=fields["format"], tune=text),)


def _copied(
    make: type[Message], *left_out: str, **renamed: str
) -> Callable[[Fields, Inbound], tuple[Message]]:
    """Return a receiver that copies fields of the same names, and sets the target and time fields."""
    names = make.__match_args__

    def receive(fields: Fields, inbound: Inbound) -> tuple[Message]:
        values = {
            renamed.get(name, name): value
            for name, value in fields.items()
            if name not in ("header", *left_out)
        }
        finite(*(value for value in values.values() if isinstance(value, float)))
        given = inbound.addressed | {"time_usec": inbound.microseconds}
        extra = {name: value for name, value in given.items() if name in names and name not in values}
        return (make(**values, **extra),)

    return receive


def companion(fields: Fields, _inbound: Inbound) -> tuple[Message]:
    """Return a HEARTBEAT from mavros_msgs/CompanionProcessStatus."""
    return (
        common.Heartbeat(
            type=common.MavType.ONBOARD_CONTROLLER,
            autopilot=common.MavAutopilot.INVALID,
            base_mode=0,
            system_status=fields["state"],
        ),
    )


def gimbal_attitude(make: type[Message]) -> Callable[[Fields, Inbound], tuple[Message]]:
    """Return a receiver for GIMBAL_…_SET_ATTITUDE; the quaternion has the axes of MAVLink."""

    def receive(fields: Fields, _inbound: Inbound) -> tuple[Message]:
        x, y, z, w = quaternion(fields["q"])
        return (make(**{**fields, "q": (w, x, y, z)}),)

    return receive


def mount(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return MAV_CMD_DO_MOUNT_CONTROL from mavros_msgs/MountControl, in degrees and metres."""
    names = ["pitch", "roll", "yaw", "altitude", "latitude", "longitude"]
    finite(*(fields[name] for name in names))
    params = {f"param{number}": fields[name] for number, name in enumerate(names, 1)}
    params["param5"], params["param6"] = fields["latitude"], fields["longitude"]
    command = common.MavCmd.DO_MOUNT_CONTROL
    return (common.CommandLong(**inbound.addressed, command=command, **params, param7=fields["mode"]),)


def debug_value(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return a debug message from mavros_msgs/DebugValue, by its type."""
    boot, name, data = inbound.boot_milliseconds, fields["name"][:10], fields["data"]
    kind = fields["type"]
    if kind == 1:
        x, y, z = (*data, 0.0, 0.0, 0.0)[:3]
        return (common.DebugVect(time_usec=inbound.microseconds, name=name, x=x, y=y, z=z),)
    if kind == 2:
        values = (*data, *[0.0] * 58)[:58]
        return (
            common.DebugFloatArray(
                time_usec=inbound.microseconds, name=name, array_id=max(fields["array_id"], 0), data=values
            ),
        )
    if kind == 3:
        return (common.NamedValueFloat(time_boot_ms=boot, name=name, value=fields["value_float"]),)
    if kind == 4:
        return (common.NamedValueInt(time_boot_ms=boot, name=name, value=fields["value_int"]),)
    index = min(max(fields["index"], 0), 255)
    return (common.Debug(time_boot_ms=boot, ind=index, value=fields["value_float"]),)


def flow(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return OPTICAL_FLOW_RAD from mavros_msgs/OpticalFlowRad, FLU."""
    copied = {name: value for name, value in fields.items() if name != "header"}
    finite(*(value for value in copied.values() if isinstance(value, float)))
    for name in ("integrated_y", "integrated_ygyro", "integrated_zgyro"):
        copied[name] = -copied[name]
    return (common.OpticalFlowRad(time_usec=inbound.microseconds, **copied),)


def raw_flow(fields: Fields, inbound: Inbound) -> tuple[Message]:
    """Return OPTICAL_FLOW from mavros_msgs/OpticalFlow, FLU."""
    moved, metres, rate = (vector(fields[name]) for name in ("flow", "flow_comp_m", "flow_rate"))
    finite(fields["ground_distance"])
    return (
        common.OpticalFlow(
            time_usec=inbound.microseconds,
            flow_x=round(moved[0]), flow_y=round(-moved[1]),
            flow_comp_m_x=metres[0], flow_comp_m_y=-metres[1],
            quality=fields["quality"], ground_distance=fields["ground_distance"],
            flow_rate_x=rate[0], flow_rate_y=-rate[1],
        ),
    )  # fmt: skip


def remote_id(make: type[Message], **sizes: int) -> Callable[[Fields, Inbound], tuple[Message]]:
    """Return a receiver for a message of OpenDroneID, whose texts are bytes of a fixed size there."""

    def receive(fields: Fields, inbound: Inbound) -> tuple[Message]:
        values = {name: value for name, value in fields.items() if name != "header"}
        finite(*(value for value in values.values() if isinstance(value, float)))
        for name, size in sizes.items():
            if not make.__name__.endswith(("SelfId", "OperatorId")) or name == "id_or_mac":
                values[name] = values[name].encode()[:size].ljust(size, b"\0")
            else:
                values[name] = values[name][:size]
        return (make(**inbound.addressed, **values),)

    return receive


def _row(
    name: str,
    kind: str,
    target: type[Message],
    receive: Any,
    qos: Qos = DEFAULT,
    role: Role = Role.OPERATE,
    *,
    stream: bool = False,
    meaning: str = "",
) -> Subscription:
    full = kind if "/" in kind else f"mavros_msgs/msg/{kind}"
    return Subscription(name, full, (target,), receive, qos, role, stream=stream, meaning=meaning)


_MANAGER: Final = common.GimbalManagerSetAttitude
_BASIC: Final = common.OpenDroneIdBasicId

ROWS: Final = (
    _row("statustext/send", "StatusText", common.Statustext, status_text, SENSOR),
    _row("rc/override", "OverrideRCIn", common.RcChannelsOverride, override, stream=True, meaning="µs"),
    _row("manual_control/send", "ManualControl", common.ManualControl, manual_control, stream=True),
    _row("home_position/set", "HomePosition", common.SetHomePosition, home, meaning="m above the ellipsoid"),
    _row("adsb/send", "ADSBVehicle", common.AdsbVehicle, adsb),
    _row(
        "actuator_control",
        "ActuatorControl",
        common.SetActuatorControlTarget,
        actuator_controls,
        SENSOR,
        Role.ADMINISTER,
        stream=True,
    ),
    _row("tunnel/in", "Tunnel", common.Tunnel, tunnel, role=Role.ADMINISTER),
    _row("play_tune", "PlayTuneV2", common.PlayTuneV2, tune, NEWEST),
    _row(
        "onboard_computer/status",
        "OnboardComputerStatus",
        common.OnboardComputerStatus,
        _copied(common.OnboardComputerStatus, "component"),
    ),
    _row(
        "cellular_status/status",
        "CellularStatus",
        common.CellularStatus,
        _copied(common.CellularStatus),
        NEWEST,
    ),
    _row("companion_process/status", "CompanionProcessStatus", common.Heartbeat, companion),
    _row("mount_control/command", "MountControl", common.CommandLong, mount, meaning="degrees"),
    _row(
        "gimbal_control/device/set_attitude",
        "GimbalDeviceSetAttitude",
        common.GimbalDeviceSetAttitude,
        gimbal_attitude(common.GimbalDeviceSetAttitude),
        stream=True,
    ),
    _row(
        "gimbal_control/manager/set_attitude",
        "GimbalManagerSetAttitude",
        _MANAGER,
        gimbal_attitude(_MANAGER),
        stream=True,
    ),
    _row(
        "gimbal_control/manager/set_pitchyaw",
        "GimbalManagerSetPitchyaw",
        common.GimbalManagerSetPitchyaw,
        _copied(common.GimbalManagerSetPitchyaw),
        stream=True,
        meaning="rad, rad/s",
    ),
    _row(
        "gimbal_control/manager/set_manual_control",
        "GimbalManagerSetPitchyaw",
        common.GimbalManagerSetManualControl,
        _copied(common.GimbalManagerSetManualControl),
        stream=True,
    ),
    _row("debug_value/send", "DebugValue", common.Debug, debug_value, role=Role.ADMINISTER),
    _row("px4flow/raw/send", "OpticalFlowRad", common.OpticalFlowRad, flow, NEWEST, stream=True),
    _row("optical_flow/raw/send", "OpticalFlow", common.OpticalFlow, raw_flow, NEWEST, stream=True),
    _row(
        "open_drone_id/basic_id",
        "OpenDroneIDBasicID",
        _BASIC,
        remote_id(_BASIC, id_or_mac=_ID_SIZE, uas_id=_UAS_SIZE),
        NEWEST,
    ),
    _row(
        "open_drone_id/operator_id",
        "OpenDroneIDOperatorID",
        common.OpenDroneIdOperatorId,
        remote_id(common.OpenDroneIdOperatorId, id_or_mac=_ID_SIZE, operator_id=_UAS_SIZE),
        NEWEST,
    ),
    _row(
        "open_drone_id/self_id",
        "OpenDroneIDSelfID",
        common.OpenDroneIdSelfId,
        remote_id(common.OpenDroneIdSelfId, id_or_mac=_ID_SIZE, description=_DESCRIPTION_SIZE),
        NEWEST,
    ),
    _row(
        "open_drone_id/system",
        "OpenDroneIDSystem",
        common.OpenDroneIdSystem,
        remote_id(common.OpenDroneIdSystem, id_or_mac=_ID_SIZE),
        NEWEST,
    ),
    _row(
        "open_drone_id/system_update",
        "OpenDroneIDSystemUpdate",
        common.OpenDroneIdSystemUpdate,
        remote_id(common.OpenDroneIdSystemUpdate),
        NEWEST,
    ),
    Subscription(
        "mavlink_sink",
        "mavros_msgs/msg/Mavlink",
        (),
        packet_sink,
        PACKETS,
        Role.ADMINISTER,
        meaning="packets, sent as they are",
        difference="one pair of topics for each vehicle, below its namespace; MAVROS has /uas1/…",
    ),
)
