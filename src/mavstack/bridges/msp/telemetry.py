"""MAVLink messages out of MSP messages: sensors, attitude, position, battery, RC channels, outputs.

Each message names the MSP messages that it is made of; they are polled at the rate of the fastest message
that needs them, and the first of them sends it. A value that the flight controller does not have is marked as
the definition of the message says, or the message is not sent: no position without a GPS fix.

MSP's pitch is positive with the nose down, MAVLink's with the nose up. Altitudes of MSP are above the place
of arming, those of the GPS receiver above mean sea level.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, nan, radians, sin
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.msp.messages.battery import Analog, BatteryState, InavAnalog
from mavstack.msp.messages.gps import RawGps
from mavstack.msp.messages.motors import Motor, MotorTelemetry
from mavstack.msp.messages.rc import Rc
from mavstack.msp.messages.sensors import Altitude, Attitude, RawImu

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.bridges.msp.rc_channels import RcChannels
    from mavstack.bridges.msp.samples import Samples
    from mavstack.dialects import Message
    from mavstack.msp.messages.base import MspMessage

_UNKNOWN_U8: Final = 0xFF
_UNKNOWN_U16: Final = 0xFFFF
_UNKNOWN_INT16: Final = 0x7FFF
_MAX_RSSI: Final = 1023
#: Maximum value of RSSI in RC_CHANNELS; 255 means unknown.
_MAX_MAVLINK_RSSI: Final = 254
_MAX_CELLS: Final = 10
_THROTTLE: Final = 3
_RC_CHANNELS: Final = 18
_OUTPUTS: Final = 16
_ESC_GROUP: Final = 4
_INAV_3D_FIX: Final = 2
#: Values of GPS_FIX_TYPE.
_FIX_2D, _FIX_3D = common.GpsFixType(2), common.GpsFixType(3)


@dataclass(frozen=True, slots=True)
class StreamedMessage:
    """A message that is made of polled ones.

    Attributes:
        message: Its class.
        sources: The MSP messages that it is made of; the first one sends it.
        interval: Seconds between two of them by default; 0: only on request, and at rates that are set.
        produce: Makes it; None if values are missing.
    """

    message: type[Message]
    sources: tuple[type[MspMessage], ...]
    interval: float
    produce: Callable[[], Message | tuple[Message, ...] | None]


class TelemetryMessages:
    """Makes the messages of one flight controller.

    Args:
        samples: The latest MSP messages.
        channels: The RC channels, which know the order of the receiver.
        is_inav: True for iNav.
    """

    def __init__(self, samples: Samples, channels: RcChannels, *, is_inav: bool) -> None:
        self._samples = samples
        self._channels = channels
        self._is_inav = is_inav

    def streamed(self) -> tuple[StreamedMessage, ...]:
        """Return all messages."""
        found = (
            StreamedMessage(common.Attitude, (Attitude,), 0.1, self.attitude),
            StreamedMessage(common.GlobalPositionInt, (RawGps, Altitude, Attitude), 0.25, self.position),
            StreamedMessage(common.GpsRawInt, (RawGps,), 0.5, self.gps),
            StreamedMessage(common.VfrHud, (Altitude, RawGps, Attitude, Rc), 0.25, self.vfr_hud),
            StreamedMessage(common.RcChannels, (Rc, self._analog), 0.25, self.rc_channels),
            StreamedMessage(common.ServoOutputRaw, (Motor,), 1.0, self.outputs),
            StreamedMessage(common.BatteryStatus, (BatteryState, self._analog), 1.0, self.battery),
            StreamedMessage(common.RawImu, (RawImu,), 0.0, self.raw_imu),
        )
        escs = StreamedMessage(common.EscStatus, (MotorTelemetry,), 0.0, self.esc_status)
        return found if self._is_inav else (*found, escs)

    @property
    def _analog(self) -> type[MspMessage]:
        return InavAnalog if self._is_inav else Analog

    def attitude(self) -> common.Attitude | None:
        """Return ATTITUDE; MSP has no rates with it."""
        attitude = self._samples.get(Attitude)
        if attitude is None:
            return None
        heading = (attitude.heading + 180) % 360 - 180
        return common.Attitude(
            time_boot_ms=self._samples.time_boot_ms(Attitude),
            roll=radians(attitude.roll),
            pitch=-radians(attitude.pitch),
            yaw=radians(heading),
            rollspeed=nan,
            pitchspeed=nan,
            yawspeed=nan,
        )

    def position(self) -> common.GlobalPositionInt | None:
        """Return GLOBAL_POSITION_INT; None without a fix."""
        gps, altitude = self._samples.get(RawGps), self._samples.get(Altitude)
        if gps is None or not gps.fix_type:
            return None
        course = radians(gps.ground_course)
        return common.GlobalPositionInt(
            time_boot_ms=self._samples.time_boot_ms(RawGps),
            lat=round(gps.latitude * 1e7),
            lon=round(gps.longitude * 1e7),
            alt=gps.altitude * 1000,
            relative_alt=0 if altitude is None else millimeters(altitude.altitude),
            vx=_int16(gps.ground_speed * cos(course) * 100),
            vy=_int16(gps.ground_speed * sin(course) * 100),
            vz=0 if altitude is None else _int16(-altitude.climb_rate * 100),
            hdg=self._heading_centidegrees(),
        )

    def gps(self) -> common.GpsRawInt | None:
        """Return GPS_RAW_INT."""
        gps = self._samples.get(RawGps)
        if gps is None:
            return None
        return common.GpsRawInt(
            time_usec=self._samples.time_boot_ms(RawGps) * 1000,
            fix_type=self._fix(gps),
            lat=round(gps.latitude * 1e7),
            lon=round(gps.longitude * 1e7),
            alt=gps.altitude * 1000,
            eph=_UNKNOWN_U16 if gps.dilution is None else min(round(gps.dilution * 100), _UNKNOWN_U16),
            epv=_UNKNOWN_U16,
            vel=min(round(gps.ground_speed * 100), _UNKNOWN_U16),
            cog=round(gps.ground_course * 100) % 36_000,
            satellites_visible=gps.satellites,
        )

    def vfr_hud(self) -> common.VfrHud | None:
        """Return VFR_HUD; its altitude is above mean sea level with a fix, else above the place of arming."""
        altitude, gps, attitude = (
            self._samples.get(Altitude),
            self._samples.get(RawGps),
            self._samples.get(Attitude),
        )
        if altitude is None:
            return None
        has_fix = gps is not None and gps.fix_type
        return common.VfrHud(
            airspeed=nan,
            groundspeed=gps.ground_speed if gps is not None and has_fix else nan,
            heading=0 if attitude is None else attitude.heading % 360,
            throttle=self._throttle_percent(),
            alt=gps.altitude if gps is not None and has_fix else altitude.altitude,
            climb=altitude.climb_rate,
        )

    def rc_channels(self) -> common.RcChannels | None:
        """Return RC_CHANNELS, in the order of the receiver."""
        rc = self._samples.get(Rc)
        if rc is None:
            return None
        pulses = self._channels.to_receiver_order(rc.channels)[:_RC_CHANNELS]
        values = {f"chan{index}_raw": _UNKNOWN_U16 for index in range(1, _RC_CHANNELS + 1)}
        values |= {f"chan{index}_raw": pulse for index, pulse in enumerate(pulses, 1)}
        return common.RcChannels(
            time_boot_ms=self._samples.time_boot_ms(Rc), chancount=len(pulses), rssi=self._rssi(), **values
        )

    def outputs(self) -> common.ServoOutputRaw | None:
        """Return SERVO_OUTPUT_RAW with the pulses of the motors."""
        motors = self._samples.get(Motor)
        if motors is None:
            return None
        pulses = {f"servo{index}_raw": pulse for index, pulse in enumerate(motors.motors[:_OUTPUTS], 1)}
        return common.ServoOutputRaw(time_usec=self._samples.time_boot_ms(Motor) * 1000, port=0, **pulses)

    def battery(self) -> common.BatteryStatus | None:
        """Return BATTERY_STATUS."""
        power = self.power()
        if power is None:
            return None
        voltages = [_UNKNOWN_U16] * _MAX_CELLS
        voltages[0] = min(round(power.voltage * 1000), _UNKNOWN_U16 - 1)
        return common.BatteryStatus(
            id=0,
            battery_function=common.MavBatteryFunction.ALL,
            temperature=_UNKNOWN_INT16,
            voltages=tuple(voltages),
            current_battery=_int16(power.current * 100),
            current_consumed=power.consumed,
            energy_consumed=-1,
            battery_remaining=power.remaining,
            charge_state=power.charge_state,
        )

    def power(self) -> Power | None:
        """Return voltage, current and charge of the battery; None if they are not known."""
        state = self._samples.get(BatteryState)
        if state is None:
            return None
        voltage = state.coarse_voltage if state.voltage is None else state.voltage
        return Power(
            voltage,
            state.current,
            state.consumed_charge,
            self._remaining(state),
            _charge_state(int(state.alert)),
        )

    def raw_imu(self) -> common.RawImu | None:
        """Return RAW_IMU, in counts of the sensors."""
        imu = self._samples.get(RawImu)
        if imu is None:
            return None
        vectors = {"acc": imu.accelerations, "gyro": imu.rates, "mag": imu.magnetic_field}
        values = {
            f"{axis}{name}": vector[i] for name, vector in vectors.items() for i, axis in enumerate("xyz")
        }
        return common.RawImu(time_usec=self._samples.time_boot_ms(RawImu) * 1000, **values)

    def esc_status(self) -> tuple[common.EscStatus, ...] | None:
        """Return ESC_STATUS of each group of four ESCs."""
        telemetry = self._samples.get(MotorTelemetry)
        if telemetry is None or not telemetry.motors:
            return None
        time = self._samples.time_boot_ms(MotorTelemetry) * 1000
        groups = range(0, len(telemetry.motors), _ESC_GROUP)
        return tuple(self._esc_group(telemetry, start, time) for start in groups)

    @staticmethod
    def _esc_group(telemetry: MotorTelemetry, start: int, time: int) -> common.EscStatus:
        motors = telemetry.motors[start : start + _ESC_GROUP]
        missing = _ESC_GROUP - len(motors)
        return common.EscStatus(
            index=start,
            time_usec=time,
            rpm=(*(motor.rpm for motor in motors), *[0] * missing),
            voltage=(*(motor.voltage for motor in motors), *[nan] * missing),
            current=(*(motor.current for motor in motors), *[nan] * missing),
        )

    def _fix(self, gps: RawGps) -> common.GpsFixType:
        if not gps.fix_type:
            return common.GpsFixType.NO_FIX
        is_2d = self._is_inav and gps.fix_type < _INAV_3D_FIX
        return _FIX_2D if is_2d else _FIX_3D

    def _heading_centidegrees(self) -> int:
        attitude = self._samples.get(Attitude)
        return _UNKNOWN_U16 if attitude is None else attitude.heading % 360 * 100

    def _throttle_percent(self) -> int:
        rc = self._samples.get(Rc)
        if rc is None or len(rc.channels) <= _THROTTLE:
            return 0
        return min(max((rc.channels[_THROTTLE] - 1000) // 10, 0), 100)

    def _rssi(self) -> int:
        analog = self._samples.get(InavAnalog) or self._samples.get(Analog)
        if analog is None:
            return _UNKNOWN_U8
        return min(analog.rssi, _MAX_RSSI) * _MAX_MAVLINK_RSSI // _MAX_RSSI

    def _remaining(self, state: BatteryState) -> int:
        """Return the remaining charge in percent, -1 if it is not known."""
        analog = self._samples.get(InavAnalog)
        if analog is not None:
            return min(analog.remaining, 100) if state.cell_count else -1
        if not state.capacity:
            return -1
        return max(100 - state.consumed_charge * 100 // state.capacity, 0)


@dataclass(frozen=True, slots=True)
class Power:
    """The battery: volts, amperes, mAh consumed, percent left (-1: unknown), MAV_BATTERY_CHARGE_STATE."""

    voltage: float
    current: float
    consumed: int
    remaining: int
    charge_state: int


def _charge_state(alert: int) -> int:
    states = common.MavBatteryChargeState
    return {0: states.OK, 1: states.LOW, 2: states.CRITICAL}.get(alert, states.UNDEFINED)


def millimeters(altitude: float) -> int:
    """Return an altitude in meters as the integer of a message."""
    return max(-0x8000_0000, min(0x7FFF_FFFF, round(altitude * 1000)))


def _int16(value: float) -> int:
    return max(-0x8000, min(0x7FFF, round(value)))
