"""Rows of devices and payloads: radio control, ESCs, gimbals, cameras, transponder, tunnels, logs."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.frames import (
    frd_flu,
    ned_enu,
    ros_attitude_of,
    to_ros_attitude,
)
from mavstack.bridges.core.qos import DEFAULT, SENSOR, Qos
from mavstack.bridges.core.row import Publication, Source, Values, fields
from mavstack.bridges.core.view import to_ellipsoid
from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from mavstack.bridges.core.view import VehicleView
    from mavstack.dialects import Message

_LOG_QOS: Final = Qos("log", reliable=True, latched=False, depth=1000)
_CALIBRATION: Final = Qos("calibration", reliable=True, latched=False, depth=2)
_ESC_GROUPS: Final = (ardupilotmega.EscTelemetry1To4, ardupilotmega.EscTelemetry5To8)
_UNKNOWN_16: Final = 0xFFFF


def rc_in(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/RCIn in microseconds."""
    count = min(message.chancount, 18)
    return message.rssi, tuple(getattr(message, f"chan{number}_raw") for number in range(1, count + 1))


def rc_out(message: Any, _view: VehicleView) -> Values | None:
    """Return mavros_msgs/RCOut in microseconds, of the first port."""
    if message.port:
        return None
    return (tuple(getattr(message, f"servo{number}_raw") for number in range(1, 17)),)


def esc_telemetry(message: Any, view: VehicleView) -> Values | None:
    """Return mavros_msgs/ESCTelemetry of all ESCs, when the last group of them was received."""
    groups = [found for kind in _ESC_GROUPS if (found := view.latest(kind)) is not None]
    if not groups or type(message) is not type(groups[-1]):
        return None
    return (tuple(_esc(group, index, view) for group in groups for index in range(4)),)


def _esc(group: Any, index: int, view: VehicleView) -> Values:
    return (
        *_header(group, view),
        float(group.temperature[index]),
        group.voltage[index] / 100,
        group.current[index] / 100,
        group.totalcurrent[index] / 1000,
        group.rpm[index],
        group.count[index],
    )


def _header(message: Message, view: VehicleView, frame: str = "") -> tuple[int, int, str]:
    seconds, nanoseconds = divmod(view.stamp(message), 1_000_000_000)
    return seconds, nanoseconds, frame


def esc_info(message: Any, view: VehicleView) -> Values:
    """Return mavros_msgs/ESCInfo of up to four ESCs."""
    header = _header(message, view)
    items = tuple(
        (*header, message.failure_flags[index], message.error_count[index], message.temperature[index])
        for index in range(min(4, max(message.count - message.index, 0)))
    )
    return message.counter, message.count, message.connection_type, message.info, items


def esc_status(message: Any, view: VehicleView) -> Values:
    """Return mavros_msgs/ESCStatus of four ESCs."""
    header = _header(message, view)
    return (
        tuple(
            (*header, message.rpm[index], message.voltage[index], message.current[index])
            for index in range(4)
        ),
    )


def adsb(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/ADSBVehicle."""
    return (
        message.ICAO_address,
        message.callsign,
        message.lat / 1e7,
        message.lon / 1e7,
        message.altitude / 1e3,
        message.heading / 1e2,
        message.hor_velocity / 1e2,
        message.ver_velocity / 1e2,
        message.altitude_type,
        message.emitter_type,
        *(message.tslc, 0),
        message.flags,
        message.squawk,
    )


def image_captured(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/CameraImageCaptured."""
    latitude, longitude = message.lat / 1e7, message.lon / 1e7
    return (
        *to_ros_attitude(*message.q),
        *(latitude, longitude, to_ellipsoid(latitude, longitude, message.alt / 1e3)),
        message.relative_alt / 1e3,
        message.image_index,
        message.capture_result,
        message.file_url,
    )


def camera_trigger(message: Any, view: VehicleView) -> Values:
    """Return mavros_msgs/CamIMUStamp."""
    seconds, nanoseconds, _ = _header(message, view)
    return seconds, nanoseconds, message.seq & 0x7FFFFFFF


def gimbal_attitude(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/GimbalDeviceAttitudeStatus; the quaternion is not converted, as in MAVROS."""
    w, x, y, z = message.q
    rates = message.angular_velocity_x, message.angular_velocity_y, message.angular_velocity_z
    target = message.target_system, message.target_component, message.flags
    return *target, x, y, z, w, *rates, message.failure_flags


def mount_orientation(message: Any, _view: VehicleView) -> Values:
    """Return geometry_msgs/Quaternion of a mount, FLU in ENU."""
    angles = (radians(message.roll), radians(message.pitch), radians(message.yaw_absolute))
    return ros_attitude_of(*angles)


def mount_status(message: Any, _view: VehicleView) -> Values:
    """Return geometry_msgs/Vector3Stamped: roll, pitch and yaw of a mount in degrees."""
    return message.pointing_b / 100, message.pointing_a / 100, message.pointing_c / 100


def landing_target(message: Any, _view: VehicleView) -> Values:
    """Return geometry_msgs/PoseStamped of a landing target in the map frame."""
    return *ned_enu(message.x, message.y, message.z), *to_ros_attitude(*message.q)


def landing_marker(message: Any, _view: VehicleView) -> Values:
    """Return geometry_msgs/Vector3Stamped: where a landing target is, in FLU from the camera."""
    return frd_flu(message.x, message.y, message.z)


def tunnel(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/Tunnel."""
    target = message.target_system, message.target_component
    return *target, message.payload_type, message.payload_length, *message.payload


def actuator_controls(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/ActuatorControl."""
    return message.group_mlx, *message.controls


def hil_actuators(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/HilActuatorControls."""
    return *message.controls, message.mode, message.flags


def calibration_status(message: Any, _view: VehicleView) -> Values:
    """Return std_msgs/UInt8: the percentage of a calibration of the magnetometer."""
    return (message.completion_pct,)


def calibration_report(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/MagnetometerReporter."""
    values = (
        "cal_mask cal_status autosaved fitness ofs_x ofs_y ofs_z diag_x diag_y diag_z offdiag_x offdiag_y "
        "offdiag_z orientation_confidence old_orientation new_orientation scale_factor"
    )
    return 1, 100.0, message.compass_id, *(getattr(message, name) for name in values.split())


def log_entry(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/LogEntry."""
    return message.id, message.num_logs, message.last_log_num, message.time_utc, 0, message.size


def log_data(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/LogData."""
    return message.id, message.ofs, bytes(message.data[: message.count])


_MANUAL: Final = [
    "x",
    "y",
    "z",
    "r",
    "buttons",
    "buttons2",
    "enabled_extensions",
    "s",
    "t",
    "aux1",
    "aux2",
    "aux3",
    "aux4",
    "aux5",
    "aux6",
]
_HIL: Final = [
    "roll_ailerons",
    "pitch_elevator",
    "yaw_rudder",
    "throttle",
    "aux1",
    "aux2",
    "aux3",
    "aux4",
    "mode",
    "nav_mode",
]
_GIMBAL_DEVICE: Final = [
    "vendor_name",
    "model_name",
    "custom_name",
    "firmware_version",
    "hardware_version",
    "uid",
    "cap_flags",
    "custom_cap_flags",
    "roll_min",
    "roll_max",
    "pitch_min",
    "pitch_max",
    "yaw_min",
    "yaw_max",
]
_GIMBAL_MANAGER: Final = [
    "cap_flags",
    "gimbal_device_id",
    "roll_min",
    "roll_max",
    "pitch_min",
    "pitch_max",
    "yaw_min",
    "yaw_max",
]
_GIMBAL_STATUS: Final = [
    "flags",
    "gimbal_device_id",
    "primary_control_sysid",
    "primary_control_compid",
    "secondary_control_sysid",
    "secondary_control_compid",
]
_M: Final = "mavros_msgs/msg/"


def _row(
    name: str, kind: str, source: Any, convert: Any, qos: Qos = DEFAULT, meaning: str = ""
) -> Publication:
    sources = source if isinstance(source, tuple) else (source,)
    full = kind if "/" in kind else _M + kind
    return Publication(name, full, sources, convert, qos, meaning=meaning, source=Source.SYSTEM)


ROWS: Final = (
    _row("rc/in", "RCIn", common.RcChannels, rc_in, meaning="µs"),
    _row("rc/out", "RCOut", common.ServoOutputRaw, rc_out, meaning="µs"),
    _row("manual_control/control", "ManualControl", common.ManualControl, fields(*_MANUAL)),
    _row("esc_telemetry/telemetry", "ESCTelemetry", _ESC_GROUPS, esc_telemetry, meaning="°C, V, A, Ah"),
    _row("esc_status/info", "ESCInfo", common.EscInfo, esc_info),
    _row("esc_status/status", "ESCStatus", common.EscStatus, esc_status, meaning="1/min, V, A"),
    _row("adsb/vehicle", "ADSBVehicle", common.AdsbVehicle, adsb, meaning="degrees, m, m/s"),
    _row("camera/image_captured", "CameraImageCaptured", common.CameraImageCaptured, image_captured),
    _row("cam_imu_sync/cam_imu_stamp", "CamIMUStamp", common.CameraTrigger, camera_trigger),
    _row(
        "gimbal_control/device/attitude_status",
        "GimbalDeviceAttitudeStatus",
        common.GimbalDeviceAttitudeStatus,
        gimbal_attitude,
        meaning="axes of MAVLink, as in MAVROS",
    ),
    _row(
        "gimbal_control/device/info",
        "GimbalDeviceInformation",
        common.GimbalDeviceInformation,
        fields(*_GIMBAL_DEVICE),
    ),
    _row(
        "gimbal_control/manager/info",
        "GimbalManagerInformation",
        common.GimbalManagerInformation,
        fields(*_GIMBAL_MANAGER),
    ),
    _row(
        "gimbal_control/manager/status",
        "GimbalManagerStatus",
        common.GimbalManagerStatus,
        fields(*_GIMBAL_STATUS),
    ),
    _row(
        "mount_control/orientation",
        "geometry_msgs/msg/Quaternion",
        common.MountOrientation,
        mount_orientation,
    ),
    _row(
        "mount_control/status",
        "geometry_msgs/msg/Vector3Stamped",
        ardupilotmega.MountStatus,
        mount_status,
        meaning="degrees",
    ),
    _row(
        "landing_target/pose_in",
        "geometry_msgs/msg/PoseStamped",
        common.LandingTarget,
        landing_target,
        SENSOR,
        "m in ENU",
    ),
    _row(
        "landing_target/lt_marker",
        "geometry_msgs/msg/Vector3Stamped",
        common.LandingTarget,
        landing_marker,
        SENSOR,
        "m in FLU",
    ),
    _row("tunnel/out", "Tunnel", common.Tunnel, tunnel),
    _row(
        "target_actuator_control", "ActuatorControl", common.ActuatorControlTarget, actuator_controls, SENSOR
    ),
    _row("hil/controls", "HilControls", common.HilControls, fields(*_HIL)),
    _row("hil/actuator_controls", "HilActuatorControls", common.HilActuatorControls, hil_actuators),
    _row(
        "mag_calibration/status",
        "std_msgs/msg/UInt8",
        ardupilotmega.MagCalProgress,
        calibration_status,
        _CALIBRATION,
    ),
    _row(
        "mag_calibration/report",
        "MagnetometerReporter",
        common.MagCalReport,
        calibration_report,
        _CALIBRATION,
    ),
    _row("log_transfer/raw/log_entry", "LogEntry", common.LogEntry, log_entry, _LOG_QOS),
    _row("log_transfer/raw/log_data", "LogData", common.LogData, log_data, _LOG_QOS),
)
