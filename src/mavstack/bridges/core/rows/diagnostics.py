"""The rows of /diagnostics: short statements about a vehicle, each with a level."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.mode_texts import mode_text
from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from mavstack.bridges.core.row import Values
    from mavstack.bridges.core.view import VehicleView

_OK, _WARNING, _ERROR, _STALE = range(4)
_FIX_3D: Final = 3
_LOW: Final = 20
_SENSOR: Final = common.MavSysStatusSensor
Status = tuple[int, str, str, str, tuple[tuple[str, str], ...]]


def diagnostics(_message: Any, view: VehicleView) -> Values:
    """Return diagnostic_msgs/DiagnosticArray."""
    found = (_connection(view), _gnss(view), _battery(view), _system(view), _time(view), _board(view))
    return (tuple(status for status in found if status is not None),)


def _status(view: VehicleView, level: int, name: str, text: str, **values: object) -> Status:
    pairs = tuple((key.replace("_", " "), str(value)) for key, value in values.items())
    return level, f"mavlink {view.system}: {name}", text, f"system {view.system}", pairs


def _connection(view: VehicleView) -> Status:
    heartbeat = view.latest(common.Heartbeat)
    if heartbeat is None or not view.connected:
        return _status(view, _ERROR, "heartbeat", "no heartbeat arrives")
    return _status(
        view,
        _OK,
        "heartbeat",
        "connected",
        mode=mode_text(heartbeat),
        vehicle_type=int(heartbeat.type),
        autopilot=int(heartbeat.autopilot),
        system_status=int(heartbeat.system_status),
    )


def _gnss(view: VehicleView) -> Status | None:
    receiver = view.latest(common.GpsRawInt)
    if receiver is None:
        return None
    good = receiver.fix_type >= _FIX_3D
    text = "3D fix" if good else "no 3D fix"
    values = {"satellites": receiver.satellites_visible, "fix_type": int(receiver.fix_type)}
    return _status(view, _OK if good else _WARNING, "GNSS", text, **values, eph=receiver.eph / 100)


def _battery(view: VehicleView) -> Status | None:
    battery = view.latest(common.BatteryStatus) or view.latest(common.SysStatus)
    if battery is None:
        return None
    left = battery.battery_remaining
    level = _WARNING if 0 <= left < _LOW else _OK
    text = "remaining charge not known" if left < 0 else f"{left} %"
    return _status(view, level, "battery", text, current=battery.current_battery / 100)


def _system(view: VehicleView) -> Status | None:
    system = view.latest(common.SysStatus)
    if system is None:
        return None
    enabled = int(system.onboard_control_sensors_enabled)
    bad = enabled & ~int(system.onboard_control_sensors_health)
    names = [str(sensor.name) for sensor in _SENSOR if sensor & bad and sensor != _SENSOR.PREARM_CHECK]
    if names:
        return _status(view, _ERROR, "system", f"not healthy: {', '.join(names)}", load=system.load / 1000)
    refuses = bool(bad & _SENSOR.PREARM_CHECK)
    text = "checks before arming fail" if refuses else "healthy"
    return _status(view, _WARNING if refuses else _OK, "system", text, load=system.load / 1000)


def _time(view: VehicleView) -> Status | None:
    offset = view.clock.timesync_offset
    if offset is None:
        return None
    return _status(view, _OK, "time", "synchronised by TIMESYNC", offset_ns=offset)


def _board(view: VehicleView) -> Status | None:
    memory, hardware = view.latest(ardupilotmega.Meminfo), view.latest(ardupilotmega.Hwstatus)
    if memory is None and hardware is None:
        return None
    free = "" if memory is None else max(memory.freemem, memory.freemem32)
    supply = "" if hardware is None else hardware.Vcc / 1000
    return _status(view, _OK, "board", "as reported", free_memory=free, supply_volts=supply)
