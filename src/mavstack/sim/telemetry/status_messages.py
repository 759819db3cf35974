"""Messages about the vehicle's state: sensor health, battery, power, time, home, mission and fence."""

from __future__ import annotations

from math import isfinite, nan
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.rotation import from_euler
from mavstack.sim.autopilot.terrain import terrain_report
from mavstack.sim.telemetry.health import SensorHealth
from mavstack.sim.telemetry.scaling import INT16_MAX, UINT16_MAX, degrees_e7, int16, int32, percent, uint16
from mavstack.sim.vehicle_types import Firmware, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.sim.motion import BatteryState
    from mavstack.sim.telemetry.health import SensorMasks
    from mavstack.sim.telemetry.view import VehicleView

_CHARGE = common.MavBatteryChargeState
_FUNCTION, _TYPE = common.MavBatteryFunction, common.MavBatteryType
_VTOL, _WINCH = common.MavVtolState, common.MavWinchStatusFlag
#: Processor load in thousandths, while disarmed and while armed.
_LOAD_IDLE, _LOAD_ARMED = 117, 173
_SUPPLY_MILLIVOLTS = 5000
_PROCESSOR_MILLIVOLTS = 3300
_FREE_BYTES = 131_072
#: Maximum voltage of one entry in BATTERY_STATUS.voltages, in millivolts; the rest continues in the next
#: entry.
_MAX_MILLIVOLTS = 65_534
_NO_CELLS = (UINT16_MAX,) * 9
#: A remaining time above this, in seconds, is reported as unknown.
_MAX_TIME_REMAINING = 86_400.0


class StatusMessages:
    """Producers of messages about the vehicle's state."""

    def __init__(self, view: VehicleView) -> None:
        self._view = view
        self._body = view.body
        self._vehicle, self._autopilot = view.vehicle, view.autopilot
        self._px4 = view.vehicle.firmware is Firmware.PX4
        health = SensorHealth(view)
        self._masks: Callable[[], SensorMasks] = health.px4 if self._px4 else health.ardupilot
        self._is_vtol = view.vehicle.vehicle_type is VehicleType.VTOL

    def system(self, now: float) -> Message:
        """Return SYS_STATUS."""
        present, enabled, health = self._masks()
        battery = self._body.battery
        return common.SysStatus(
            onboard_control_sensors_present=present,
            onboard_control_sensors_enabled=enabled,
            onboard_control_sensors_health=health,
            load=_LOAD_ARMED if self._autopilot.armed else _LOAD_IDLE,
            voltage_battery=uint16(battery.voltage * 1e3),
            current_battery=int16(battery.current * 100.0, -1),
            battery_remaining=percent(battery.remaining),
        )

    def extended(self, now: float) -> Message:
        """Return EXTENDED_SYS_STATE."""
        return common.ExtendedSysState(self._vtol_state(), self._autopilot.landed_state)

    def winch_if_fitted(self, now: float) -> Message | None:
        """Return WINCH_STATUS; None without a winch."""
        if not self._vehicle.parameters.get("WINCH_TYPE", 0):
            return None
        payload = self._autopilot.payload
        flags = _WINCH.HEALTHY | (_WINCH.MOVING if payload.winch_speed else _WINCH(0))
        return common.WinchStatus(
            time_usec=self._view.milliseconds(now) * 1000,
            line_length=payload.winch,
            speed=payload.winch_speed,
            tension=nan,
            voltage=nan,
            current=nan,
            temperature=INT16_MAX,
            status=flags | (_WINCH(0) if payload.winch else _WINCH.FULLY_RETRACTED),
        )

    def time(self, now: float) -> Message:
        """Return SYSTEM_TIME."""
        return common.SystemTime(round(now * 1e6), self._view.milliseconds(now))

    def battery(self, now: float) -> Message:
        """Return BATTERY_STATUS of the only battery."""
        battery = self._body.battery
        temperature = battery.temperature
        return common.BatteryStatus(
            battery_function=_FUNCTION.ALL if self._px4 else _FUNCTION.UNKNOWN,
            type=_TYPE.LIPO if self._px4 else _TYPE.UNKNOWN,
            temperature=int16(temperature * 100.0, INT16_MAX) if isfinite(temperature) else INT16_MAX,
            voltages=_cell_slots(battery.voltage),
            current_battery=int16(battery.current * 100.0, -1),
            current_consumed=int32(battery.consumed, -1),
            energy_consumed=-1 if self._px4 else int32(battery.consumed * battery.voltage * 0.036, -1),
            battery_remaining=percent(battery.remaining),
            time_remaining=_time_remaining(battery),
            charge_state=self._charge_state(battery),
        )

    def flight(self, now: float) -> Message:
        """Return FLIGHT_INFORMATION; despite their names, its times are microseconds since boot."""
        autopilot = self._autopilot
        armed = self._view.microseconds(autopilot.armed_at) if autopilot.armed else 0
        return common.FlightInformation(
            time_boot_ms=self._view.milliseconds(now),
            arming_time_utc=armed,
            takeoff_time_utc=0 if autopilot.landed else armed,
            flight_uuid=self._vehicle.boots,
        )

    def power(self, now: float) -> Message:
        """Return POWER_STATUS."""
        return common.PowerStatus(_SUPPLY_MILLIVOLTS, 0, common.MavPowerStatus.BRICK_VALID)

    def processor(self, now: float) -> Message:
        """Return MCU_STATUS."""
        return ardupilotmega.McuStatus(
            0,
            int16((self._view.sensors.temperature + 15.0) * 100.0),
            _PROCESSOR_MILLIVOLTS,
            _PROCESSOR_MILLIVOLTS - 10,
            _PROCESSOR_MILLIVOLTS + 10,
        )

    def memory(self, now: float) -> Message:
        """Return MEMINFO."""
        return ardupilotmega.Meminfo(0, UINT16_MAX, _FREE_BYTES)

    def hardware(self, now: float) -> Message:
        """Return HWSTATUS."""
        return ardupilotmega.Hwstatus(_SUPPLY_MILLIVOLTS, 0)

    def mission(self, now: float) -> Message:
        """Return MISSION_CURRENT."""
        return self._vehicle.mission.current_message()

    def fence(self, now: float) -> Message | None:
        """Return FENCE_STATUS, while a fence is enabled."""
        fence = self._autopilot.fence
        return fence.status() if fence.enabled else None

    def home(self, now: float) -> Message | None:
        """Return HOME_POSITION, once home is set."""
        home = self._autopilot.home
        if home is None:
            return None
        north, east, down = self._view.home
        yaw = home.heading * 0.017453292519943295
        return common.HomePosition(
            degrees_e7(home.latitude),
            degrees_e7(home.longitude),
            int32(home.altitude * 1e3),
            north,
            east,
            down,
            q=from_euler(0.0, 0.0, yaw),
            time_usec=self._view.microseconds(now),
        )

    def origin(self, now: float) -> Message | None:
        """Return GPS_GLOBAL_ORIGIN, once the estimate has one."""
        if not self._view.was_positioned:
            return None
        frame = self._body.frame
        return common.GpsGlobalOrigin(
            degrees_e7(frame.latitude),
            degrees_e7(frame.longitude),
            int32(frame.altitude * 1e3),
            self._view.microseconds(now),
        )

    def terrain(self, now: float) -> Message:
        """Return TERRAIN_REPORT of the place of the vehicle."""
        position = self._view.position
        return terrain_report(self._autopilot, position.latitude, position.longitude)

    def _vtol_state(self) -> int:
        """Return the MAV_VTOL_STATE."""
        if not self._is_vtol:
            return _VTOL.UNDEFINED
        transition, forward = self._body.transition, self._body.flies_forward
        if forward:
            return _VTOL.FW if transition >= 1.0 else _VTOL.TRANSITION_TO_FW
        return _VTOL.MC if transition <= 0.0 else _VTOL.TRANSITION_TO_MC

    def _charge_state(self, battery: BatteryState) -> int:
        """Return the MAV_BATTERY_CHARGE_STATE."""
        limits = self._charge_limits if self._px4 else self._voltage_limits
        emergency, critical, low = limits(battery)
        if emergency:
            return _CHARGE.EMERGENCY
        if critical:
            return _CHARGE.CRITICAL
        return _CHARGE.LOW if low else _CHARGE.OK

    def _charge_limits(self, battery: BatteryState) -> tuple[bool, bool, bool]:
        """Return PX4's (emergency, critical, low), by the remaining charge."""
        parameter, left = self._view.parameter, battery.remaining
        return (
            left < parameter("BAT_EMERGEN_THR", 0.05),
            left < parameter("BAT_CRIT_THR", 0.07),
            left < parameter("BAT_LOW_THR", 0.15),
        )

    def _voltage_limits(self, battery: BatteryState) -> tuple[bool, bool, bool]:
        """Return ArduPilot's limits, by voltage and charge if set; there is no emergency limit."""
        parameter, left = self._view.parameter, battery.capacity - battery.consumed
        critical = battery.voltage < parameter("BATT_CRT_VOLT", 0.0) or left < parameter("BATT_CRT_MAH", 0.0)
        low = battery.voltage < parameter("BATT_LOW_VOLT", 0.0) or left < parameter("BATT_LOW_MAH", 0.0)
        return False, critical, low


def _cell_slots(volts: float) -> tuple[int, ...]:
    """Return the total voltage in the first cell slot, and the excess in the next slots."""
    millivolts = volts * 1e3
    if millivolts <= _MAX_MILLIVOLTS:
        return (uint16(millivolts), *_NO_CELLS)
    full = int(min(millivolts / _MAX_MILLIVOLTS, 9.0)) if millivolts == millivolts else 0
    rest = uint16(millivolts - full * _MAX_MILLIVOLTS)
    return (*(_MAX_MILLIVOLTS,) * full, rest, *_NO_CELLS)[:10]


def _time_remaining(battery: BatteryState) -> int:
    """Return the seconds until the battery is empty at the present current; 0 if unknown."""
    left = battery.capacity * battery.remaining
    if not (battery.current > 0.01 and left > 0):
        return 0
    seconds = left * 3.6 / battery.current
    return max(int(seconds), 1) if seconds < _MAX_TIME_REMAINING else 0
