"""Rows of the vehicle's state: heartbeat, system, battery, texts, times, radio."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.mode_texts import mode_text
from mavstack.bridges.core.qos import DEFAULT, LATCHED, STATE
from mavstack.bridges.core.row import Publication, Source, Values, fields
from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from mavstack.bridges.core.view import VehicleView

_FLAG: Final = common.MavModeFlag
_UNKNOWN_16: Final = 0xFFFF
#: Unix time in microseconds: a clock before this time in 2009 is not set; ROS time ends in 2038.
_MIN_UNIX: Final = 1_234_567_890_000_000
_MAX_UNIX: Final = 2_147_483_647_000_000
_DISCHARGING: Final = 2
_HEALTH_UNKNOWN: Final = 0
_LIPO, _LIFE, _LION, _NIMH = 1, 2, 3, 4
#: POWER_SUPPLY_TECHNOLOGY of sensor_msgs/BatteryState by MAV_BATTERY_TYPE.
_TECHNOLOGIES: Final = {_LIPO: 3, _LIFE: 4, _LION: 2, _NIMH: 1}
#: Bits of ESTIMATOR_STATUS, in the order of the flags of mavros_msgs/EstimatorStatus.
_ESTIMATOR_BITS: Final = range(12)


def state(message: Any, view: VehicleView) -> Values:
    """Return mavros_msgs/State."""
    flags = message.base_mode
    return (
        view.connected,
        bool(flags & _FLAG.SAFETY_ARMED),
        bool(flags & _FLAG.GUIDED_ENABLED),
        bool(flags & _FLAG.MANUAL_INPUT_ENABLED),
        mode_text(message),
        message.system_status,
    )


def battery(message: Any, view: VehicleView) -> Values | None:
    """Return sensor_msgs/BatteryState of the first battery."""
    if isinstance(message, common.SysStatus):
        return None if view.latest(common.BatteryStatus) else _battery_of_system(message)
    if message.id != 0:
        return None
    cells = [mv / 1e3 for mv in message.voltages if mv != _UNKNOWN_16]
    cells += [mv / 1e3 for mv in message.voltages_ext if mv not in (0, _UNKNOWN_16)]
    temperature = nan if message.temperature == 0x7FFF else message.temperature / 100
    return _battery(sum(cells) if cells else nan, temperature, message, message.type, cells)


def _battery_of_system(message: common.SysStatus) -> Values:
    unknown = message.voltage_battery == _UNKNOWN_16
    return _battery(nan if unknown else message.voltage_battery / 1e3, nan, message, 0, [])


def _battery(voltage: float, temperature: float, message: Any, kind: int, cells: list[float]) -> Values:
    current = nan if message.current_battery < 0 else -message.current_battery / 100
    left = nan if message.battery_remaining < 0 else message.battery_remaining / 100
    supply = (_DISCHARGING, _HEALTH_UNKNOWN, _TECHNOLOGIES.get(int(kind), 0), True)
    location = f"id{message.id}" if isinstance(message, common.BatteryStatus) else ""
    return (voltage, temperature, current, nan, nan, nan, left, *supply, cells, (), location, "")


def estimator(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/EstimatorStatus; the flags of EKF_STATUS_REPORT are those of ESTIMATOR_STATUS."""
    flags = int(message.flags)
    if isinstance(message, ardupilotmega.EkfStatusReport):
        # EKF_STATUS_REPORT differs from ESTIMATOR_STATUS from bit 10 on: ArduPilot has UNINITIALIZED there,
        # and GPS_GLITCHING at bit 15.
        flags = (flags & 0x3FF) | (0x400 if flags & ardupilotmega.EkfStatusFlags.GPS_GLITCHING else 0)
    return tuple(bool(flags >> bit & 1) for bit in _ESTIMATOR_BITS)


def radio(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/RadioStatus, with the strengths in dBm as SiK radios count."""
    counts = (message.rssi, message.remrssi, message.txbuf, message.noise, message.remnoise)
    return (
        *counts,
        message.rxerrors,
        message.fixed,
        message.rssi / 1.9 - 127,
        message.remrssi / 1.9 - 127,
    )


def time_reference(message: Any, _view: VehicleView) -> Values | None:
    """Return sensor_msgs/TimeReference; None if the vehicle does not know the time."""
    if not _MIN_UNIX <= message.time_unix_usec < _MAX_UNIX:
        return None
    seconds, microseconds = divmod(message.time_unix_usec, 1_000_000)
    return seconds, microseconds * 1000, "fcu"


def status_event(message: Any, _view: VehicleView) -> Values:
    """Return mavros_msgs/StatusEvent."""
    return (message.log_levels & 0x0F, message.id & 0xFFFFFF, *message.arguments, message.sequence)


_HEALTH: Final = [
    "onboard_control_sensors_present",
    "onboard_control_sensors_enabled",
    "onboard_control_sensors_health",
    "load",
    "voltage_battery",
    "current_battery",
    "battery_remaining",
    "drop_rate_comm",
    "errors_comm",
    "errors_count1",
    "errors_count2",
    "errors_count3",
    "errors_count4",
]

ROWS: Final = (
    Publication(
        "state",
        "mavros_msgs/msg/State",
        (common.Heartbeat,),
        state,
        STATE,
        meaning="mode names as MAVROS has them",
    ),
    Publication(
        "extended_state",
        "mavros_msgs/msg/ExtendedState",
        (common.ExtendedSysState,),
        fields("vtol_state", "landed_state"),
        STATE,
    ),
    Publication(
        "sys_status",
        "mavros_msgs/msg/SysStatus",
        (common.SysStatus,),
        fields(*_HEALTH),
        STATE,
        meaning="mV, 10 mA, % as in MAVLink",
    ),
    Publication(
        "battery",
        "sensor_msgs/msg/BatteryState",
        (common.BatteryStatus, common.SysStatus),
        battery,
        meaning="V, A (negative while discharging), 0 to 1",
    ),
    Publication(
        "statustext/recv",
        "mavros_msgs/msg/StatusText",
        (),
        None,
        DEFAULT,
        meaning="chunks joined",
        difference="reliable instead of best effort, and long texts in one piece",
    ),
    Publication(
        "status_event", "mavros_msgs/msg/StatusEvent", (common.Event,), status_event, meaning="events of PX4"
    ),
    Publication(
        "estimator_status",
        "mavros_msgs/msg/EstimatorStatus",
        (common.EstimatorStatus, ardupilotmega.EkfStatusReport),
        estimator,
        STATE,
    ),
    Publication(
        "time_reference", "sensor_msgs/msg/TimeReference", (common.SystemTime,), time_reference, frame=""
    ),
    Publication(
        "timesync_status",
        "mavros_msgs/msg/TimesyncStatus",
        (),
        None,
        meaning="ns, round trip in ms",
    ),
    Publication(
        "radio_status",
        "mavros_msgs/msg/RadioStatus",
        (common.RadioStatus,),
        radio,
        meaning="dBm as of SiK radios",
        source=Source.RADIO,
    ),
    Publication(
        "reason",
        "std_msgs/msg/String",
        (),
        None,
        LATCHED,
        meaning="why the last request was refused",
        difference="not in MAVROS",
    ),
)
