"""The messages that a flight controller sends of its motion, sensors, battery and outputs.

They are made when they are asked for, from the readings of the body at this step. MSP's pitch is positive
nose down.
"""

from __future__ import annotations

from math import atan2, degrees, hypot, sqrt
from typing import TYPE_CHECKING, Final

from mavstack.msp.messages.battery import (
    Analog,
    BatteryAlert,
    BatteryState,
    CurrentMeter,
    CurrentMeters,
    InavAnalog,
    VoltageMeter,
    VoltageMeters,
)
from mavstack.msp.messages.gps import CompGps, RawGps
from mavstack.msp.messages.motors import Motor, MotorTelemetry, MotorTelemetryItem
from mavstack.msp.messages.rc import Rc
from mavstack.msp.messages.sensors import Altitude, Attitude, AttitudeQuaternion, RawImu
from mavstack.rotation import from_euler

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.msp.messages.base import MspMessage
    from mavstack.sim.msp.system import System

#: Raw accelerometer value at 1 g by firmware, standard gravity in m/s2, and raw compass value at 1 gauss.
_COUNTS_PER_G: Final = {"BTFL": 2048.0, "INAV": 512.0}
_GRAVITY: Final = 9.80665
_COUNTS_PER_GAUSS: Final = 1090.0
#: Cell voltages at which the battery warns, and at which it is empty.
WARNING_VOLTAGE, EMPTY_VOLTAGE = 3.5, 3.3
#: Revolutions per minute of a motor at full thrust.
_FULL_RPM: Final = 25_000.0
_MAX_RSSI: Final = 1023
_MOTORS, _OUTPUTS = 4, 8
_SEA_LEVEL_TEMPERATURE: Final = 25


def attitude(controller: System) -> Attitude:
    """Return MSP_ATTITUDE."""
    estimate = controller.body.estimate
    return Attitude(degrees(estimate.roll), -degrees(estimate.pitch), round(degrees(estimate.yaw)) % 360)


def quaternion(controller: System) -> AttitudeQuaternion:
    """Return MSP_ATTITUDE_QUATERNION, in axes forward, left and up."""
    estimate = controller.body.estimate
    w, x, y, z = from_euler(estimate.roll, estimate.pitch, estimate.yaw)
    return AttitudeQuaternion(w, x, -y, -z)


def altitude(controller: System) -> Altitude:
    """Return MSP_ALTITUDE."""
    climb = -controller.body.estimate.velocity_down
    return Altitude(controller.altitude, climb, controller.altitude if controller.is_inav else None)


def raw_imu(controller: System) -> RawImu:
    """Return MSP_RAW_IMU."""
    sensors = controller.body.sensors
    scale = _COUNTS_PER_G["INAV" if controller.is_inav else "BTFL"] / _GRAVITY
    return RawImu(
        _counts(
            -scale * sensors.acceleration_x, scale * sensors.acceleration_y, -scale * sensors.acceleration_z
        ),
        _counts(degrees(sensors.gyro_x), -degrees(sensors.gyro_y), degrees(sensors.gyro_z)),
        _counts(
            *(
                _COUNTS_PER_GAUSS * each
                for each in (sensors.magnetic_x, sensors.magnetic_y, sensors.magnetic_z)
            )
        ),
    )


def _counts(*values: float) -> tuple[int, ...]:
    return tuple(round(min(max(value, -32768), 32767)) for value in values)


def raw_gps(controller: System) -> RawGps:
    """Return MSP_RAW_GPS."""
    sensors = controller.body.sensors
    north, east = sensors.gps_velocity_north, sensors.gps_velocity_east
    fixed = 2 if controller.is_inav else 1
    return RawGps(
        fix_type=fixed if controller.has_fix else 0,
        satellites=sensors.gps_satellites,
        latitude=sensors.gps_latitude,
        longitude=sensors.gps_longitude,
        altitude=round(min(max(sensors.gps_altitude, 0), 0xFFFF)),
        ground_speed=min(hypot(north, east), 655.0),
        ground_course=degrees(atan2(east, north)) % 360,
        dilution=min(sensors.gps_eph, 99.99),
    )


def comp_gps(controller: System) -> CompGps:
    """Return MSP_COMP_GPS."""
    if controller.home is None or not controller.has_fix:
        return CompGps(0, 0, 0)
    here = controller.body.estimate
    north, east = controller.home[0] - here.north, controller.home[1] - here.east
    return CompGps(
        min(round(hypot(north, east)), 0xFFFF),
        round(degrees(atan2(east, north))) % 360,
        round(controller.now) % 2,
    )


def alert(controller: System) -> BatteryAlert:
    """Return the state of the battery."""
    battery = controller.body.battery
    cell = battery.voltage / battery.cells
    if cell < EMPTY_VOLTAGE:
        return BatteryAlert.CRITICAL
    return BatteryAlert.WARNING if cell < WARNING_VOLTAGE else BatteryAlert.OK


def analog(controller: System) -> Analog:
    """Return MSP_ANALOG."""
    battery = controller.body.battery
    return Analog(
        coarse_voltage=min(battery.voltage, 25.5),
        consumed_charge=round(battery.consumed),
        rssi=rssi(controller),
        current=min(battery.current, 320.0),
        voltage=None if controller.is_inav else battery.voltage,
    )


def rssi(controller: System) -> int:
    """Return the strength of the RC signal, 0 to 1023."""
    return _MAX_RSSI if controller.receiver.has_signal(controller.now) else 0


def inav_analog(controller: System) -> InavAnalog:
    """Return MSP2_INAV_ANALOG."""
    battery = controller.body.battery
    left = max(battery.capacity - battery.consumed, 0.0)
    return InavAnalog(
        flags=1 | alert(controller) << 2 | battery.cells << 4,
        voltage=battery.voltage,
        current=min(battery.current, 320.0),
        power=battery.voltage * battery.current,
        consumed_charge=round(battery.consumed),
        consumed_energy=battery.consumed * battery.voltage / 1e3,
        remaining_capacity=round(left),
        remaining=round(100 * battery.remaining),
        rssi=rssi(controller),
    )


def battery_state(controller: System) -> BatteryState:
    """Return MSP_BATTERY_STATE."""
    battery = controller.body.battery
    return BatteryState(
        cell_count=battery.cells,
        capacity=round(battery.capacity),
        coarse_voltage=min(battery.voltage, 25.5),
        consumed_charge=round(battery.consumed),
        current=min(battery.current, 320.0),
        alert=alert(controller),
        voltage=battery.voltage,
    )


def voltage_meters(controller: System) -> VoltageMeters:
    """Return MSP_VOLTAGE_METERS: the battery's meter (10)."""
    return VoltageMeters((VoltageMeter(10, min(controller.body.battery.voltage, 25.5)),))


def current_meters(controller: System) -> CurrentMeters:
    """Return MSP_CURRENT_METERS: the battery's meter (10)."""
    battery = controller.body.battery
    return CurrentMeters((CurrentMeter(10, round(battery.consumed), min(battery.current, 65.0)),))


def pulses(controller: System) -> tuple[int, ...]:
    """Return the pulse widths of four motors in microseconds: of a motor test, or of the flight."""
    if not controller.arming.armed:
        return tuple(controller.motor_test)
    return controller.body.servos[:_MOTORS]


def motor(controller: System) -> Motor:
    """Return MSP_MOTOR."""
    return Motor((*pulses(controller), *[0] * (_OUTPUTS - _MOTORS)))


def motor_telemetry(controller: System) -> MotorTelemetry:
    """Return MSP_MOTOR_TELEMETRY."""
    battery = controller.body.battery
    shares = [max(pulse - 1000, 0) / 1000 for pulse in pulses(controller)]
    total = sum(shares) or 1.0
    return MotorTelemetry(
        tuple(
            MotorTelemetryItem(
                rpm=round(_FULL_RPM * sqrt(share)),
                invalid=0,
                temperature=_SEA_LEVEL_TEMPERATURE + round(40 * share),
                voltage=battery.voltage,
                current=battery.current * share / total,
                consumed_charge=round(battery.consumed / _MOTORS),
            )
            for share in shares
        )
    )


def rc(controller: System) -> Rc:
    """Return MSP_RC."""
    receiver = controller.receiver
    return Rc(tuple(receiver.channels[: receiver.count]))


#: Messages of both firmwares, with the functions that make them; messages of one firmware are in its module.
COMMON: Final[Sequence[tuple[type[MspMessage], Callable[[System], MspMessage]]]] = (
    (Attitude, attitude),
    (Altitude, altitude),
    (RawImu, raw_imu),
    (RawGps, raw_gps),
    (CompGps, comp_gps),
    (Analog, analog),
    (BatteryState, battery_state),
    (Motor, motor),
    (Rc, rc),
)
