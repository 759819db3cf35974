"""ArduPilot's onboard logs (.BIN): records with a header of three bytes, described by FMT and FMTU.

Each sample writes ATT, POS, IMU and XKF1. Every 200 ms the slowly changing values follow: GPS, GPA, BARO,
BAT, MAG, RCIN, RCOU, XKF4, and ARSP if there is airspeed. All other records are written when they happen.
"""

from __future__ import annotations

from math import atan2, degrees, hypot, isnan
from typing import TYPE_CHECKING

from mavstack.services.frames import scale_of, to_integer
from mavstack.sim.storage.dataflash_formats import FORMATS, MULTIPLIERS, UNITS
from mavstack.sim.storage.packing import Block, channels, pressure_altitude, text_of

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem
    from mavstack.services.parameters import Value
    from mavstack.sim.storage.packing import Rounding, Scalar
    from mavstack.sim.storage.sample import FlightSample, LogStart

#: Interval of slow records, in microseconds.
SLOW_INTERVAL_US = 200_000
#: Values of ArduPilot's LogEvent.
EVENT_ARMED, EVENT_DISARMED, EVENT_LANDED, EVENT_NOT_LANDED, EVENT_SET_HOME = 10, 11, 18, 28, 25
_GPS_EPOCH, _LEAP_SECONDS, _WEEK_MS = 315_964_800, 18, 604_800_000
_CHANNELS = 14
_EKF3 = 3
#: Solution status flags of XKF4 with a position, and without a position.
_SOLUTION, _WITHOUT_POSITION = 0x33F, 0x0A7
_FAST = ("ATT", "POS", "IMU", "XKF1")
_SLOW = ("GPS", "GPA", "BARO", "BAT", "MAG", "RCIN", "RCOU", "XKF4")


def _block(*names: str) -> Block:
    """Return the block of several formats."""
    return Block("".join("3s" + FORMATS[name].codes for name in names))


_RECORDS = {name: (FORMATS[name].header, _block(name)) for name in FORMATS}
_FAST_BLOCK, _SLOW_BLOCK = _block(*_FAST), _block(*_SLOW)
_ATT, _POS, _IMU, _XKF1 = (FORMATS[name].header for name in _FAST)
_GPS, _GPA, _BARO, _BAT, _MAG, _RCIN, _RCOU, _XKF4 = (FORMATS[name].header for name in _SLOW)


def _record(name: str, *values: Scalar) -> bytes:
    """Return the bytes of one record."""
    header, block = _RECORDS[name]
    return block.pack_values(header, *values)


class DataflashWriter:
    """Writer of one log into `data`, which the caller empties from time to time."""

    def __init__(self, start: LogStart, time_us: int) -> None:
        self.data = bytearray(_formats(time_us))
        self._start = start
        self._slow_at = time_us
        self._ground: float | None = None
        self._energy = 0.0
        self._last_us = time_us
        self._write_start(time_us)

    # Records during the log

    def write(self, sample: FlightSample) -> None:
        """Write a sample."""
        self.data += _FAST_BLOCK.pack(self._fast, sample)
        if sample.time_us >= self._slow_at:
            self._slow_at = sample.time_us + SLOW_INTERVAL_US
            self.data += _SLOW_BLOCK.pack(self._slow, sample)
            if sample.airspeed != 0.0:
                header, block = _RECORDS["ARSP"]
                self.data += block.pack(lambda of, to_int: (header, *_airspeed(of, to_int)), sample)

    def text(self, time_us: int, severity: int, text: str) -> None:
        """Write a status text."""
        self._put("MSG", time_us, text_of(text, 64))

    def mode(self, time_us: int, mode: int, reason: int = 0) -> None:
        """Write a mode change; `reason` is the firmware's number."""
        self._put("MODE", time_us, mode & 0xFF, mode & 0xFF, reason)

    def armed(self, time_us: int, armed: bool, *, forced: bool = False, method: int = 0) -> None:
        """Write that the motors were armed or disarmed."""
        self._put("ARM", time_us, armed, 0, forced, method)
        self.event(time_us, EVENT_ARMED if armed else EVENT_DISARMED)

    def event(self, time_us: int, event: int) -> None:
        """Write one of the firmware's numbered events."""
        self._put("EV", time_us, event)

    def error(self, time_us: int, subsystem: int, code: int) -> None:
        """Write the failure of a subsystem; code 0 is its recovery."""
        self._put("ERR", time_us, subsystem, code)

    def parameter(self, time_us: int, name: str, value: Value, default: Value | None = None) -> None:
        """Write a parameter."""
        self._put(
            "PARM", time_us, text_of(name, 16), float(value), float(value if default is None else default)
        )

    def command(self, time_us: int, item: MissionItem, sequence: int, total: int) -> None:
        """Write a mission item when it starts."""
        scale = scale_of(item.command, item.frame)
        x, y = to_integer(item.param5, scale), to_integer(item.param6, scale)
        params = (item.param1, item.param2, item.param3, item.param4)
        self._put("CMD", time_us, total, sequence, item.command, *params, x, y, item.param7, item.frame)

    def home(self, time_us: int, latitude: float, longitude: float, altitude: float) -> None:
        """Write the home position in degrees and metres AMSL."""
        self._origin(time_us, 1, latitude, longitude, altitude)

    # Start of the log

    def _write_start(self, time_us: int) -> None:
        """Write parameters, version, mission, mode and origin."""
        start = self._start
        for parameter in start.parameters:
            self.parameter(time_us, *parameter)
        self.text(time_us, 6, start.firmware)
        git_hash = int(start.git_hash[:8], 16) if _is_hexadecimal(start.git_hash[:8]) else 0
        firmware = text_of(start.firmware, 64)
        self._put("VER", time_us, 3, 0, *start.version, 255, git_hash, firmware, 0, 0, 0, 0, 0)
        for sequence, item in enumerate(start.mission):
            self.command(time_us, item, sequence, len(start.mission))
        self.mode(time_us, start.mode)
        self._origin(time_us, 0, *start.origin)
        if start.home is not None:
            self.home(time_us, *start.home)

    def _origin(self, time_us: int, kind: int, latitude: float, longitude: float, altitude: float) -> None:
        """Write an origin (kind 0) or home (kind 1)."""
        self._put(
            "ORGN", time_us, kind, _scaled(latitude, 1e7), _scaled(longitude, 1e7), _scaled(altitude, 1e2)
        )

    def _put(self, name: str, *values: Scalar) -> None:
        """Append one record."""
        self.data += _record(name, *values)

    # Values of a sample

    def _fast(self, sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
        """Return the values of the records of each sample."""
        time, motion, sensors = sample.time_us, sample.motion, sample.sensors
        roll, pitch, yaw = degrees(motion.roll), degrees(motion.pitch), degrees(motion.yaw) % 360
        up = -motion.down
        desired_roll, desired_pitch, desired_yaw = (
            sample.desired_roll,
            sample.desired_pitch,
            sample.desired_yaw,
        )
        return (
            _ATT, time, roll if isnan(desired_roll) else degrees(desired_roll), roll,
            pitch if isnan(desired_pitch) else degrees(desired_pitch), pitch,
            yaw if isnan(desired_yaw) else degrees(desired_yaw) % 360, yaw, _EKF3,
            _POS, time, to_int(sample.latitude * 1e7), to_int(sample.longitude * 1e7), sample.altitude,
            sample.altitude - sample.home_altitude, up,
            _IMU, time, 0, sensors.gyro_x, sensors.gyro_y, sensors.gyro_z, sensors.acceleration_x,
            sensors.acceleration_y, sensors.acceleration_z, 0, 0, sensors.temperature, 1, 1, 1000, 1000,
            _XKF1, time, 0, to_int(roll * 100), to_int(pitch * 100), to_int(yaw * 100), motion.velocity_north,
            motion.velocity_east, motion.velocity_down, motion.velocity_down, motion.north, motion.east,
            motion.down, 0, 0, 0, to_int((sample.altitude - up) * 100),
        )  # fmt: skip

    def _slow(self, sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
        """Return the values of the slow records."""
        time = sample.time_us
        return (
            *self._gps(sample, to_int),
            *self._barometer(sample, to_int),
            *self._battery(sample, to_int),
            _MAG, time, 0, to_int(sample.sensors.magnetic_x * 1e3), to_int(sample.sensors.magnetic_y * 1e3),
            to_int(sample.sensors.magnetic_z * 1e3), 0, 0, 0, 0, 0, 0, 1, time & 0xFFFFFFFF,
            _RCIN, time, *channels(sample.rc, _CHANNELS, to_int),
            _RCOU, time, *channels(sample.servos, _CHANNELS, to_int),
            _XKF4, time, 0, *_variances(sample, to_int),
        )  # fmt: skip

    def _gps(self, sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
        """Return the values of GPS and GPA."""
        sensors, time = sample.sensors, sample.time_us
        north, east = sensors.gps_velocity_north, sensors.gps_velocity_east
        moment = to_int((self._start.boot - _GPS_EPOCH + _LEAP_SECONDS) * 1e3 + time / 1e3)
        accuracy = (to_int(sensors.gps_eph * 100), to_int(sensors.gps_epv * 100))
        altitude = to_int(sensors.gps_altitude * 100)
        return (
            _GPS, time, 0, sensors.gps_fix, moment % _WEEK_MS, moment // _WEEK_MS, sensors.gps_satellites,
            to_int(sensors.gps_eph * 100), to_int(sensors.gps_latitude * 1e7),
            to_int(sensors.gps_longitude * 1e7), altitude, hypot(north, east),
            degrees(atan2(east, north)) % 360, sensors.gps_velocity_down, 0.0, 1,
            _GPA, time, 0, accuracy[1], *accuracy, 20, 0.0, 1, time // 1000 & 0xFFFFFFFF, 200, altitude, 0, 0,
        )  # fmt: skip

    def _barometer(self, sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
        """Return the values of BARO."""
        sensors, time = sample.sensors, sample.time_us
        height, pressure = pressure_altitude(sensors.pressure), sensors.pressure * 100
        if self._ground is None:
            self._ground = height + min(sample.motion.down, 0.0)
        return (
            _BARO, time, 0, height - self._ground, height, pressure, to_int(sensors.temperature * 100),
            -sample.motion.velocity_down, time // 1000 & 0xFFFFFFFF, 0.0, sensors.temperature, 1, pressure,
        )  # fmt: skip

    def _battery(self, sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
        """Return the values of BAT."""
        battery, time = sample.battery, sample.time_us
        hours = max(time - self._last_us, 0) / 3.6e9
        self._last_us = max(time, self._last_us)
        energy = battery.voltage * battery.current * hours
        self._energy += 0.0 if isnan(energy) else energy
        return (
            _BAT, time, 0, battery.voltage, battery.voltage, battery.current, battery.consumed, self._energy,
            to_int(battery.temperature * 100), 0.0, to_int(battery.remaining * 100), 1, 100,
        )  # fmt: skip


def _formats(time_us: int) -> bytes:
    """Return all format, unit and multiplier records."""
    formats = [
        _record("FMT", kind.type, kind.length, kind.name.encode(), kind.format.encode(), kind.labels.encode())
        for kind in FORMATS.values()
    ]
    units = [_record("UNIT", time_us, ord(letter), name.encode()) for letter, name in UNITS.items()]
    factors = [_record("MULT", time_us, ord(letter), factor) for letter, factor in MULTIPLIERS.items()]
    field_units = [
        _record("FMTU", time_us, kind.type, kind.units.encode(), kind.multipliers.encode())
        for kind in FORMATS.values()
    ]
    return b"".join((*formats, *units, *factors, *field_units))


def _variances(sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
    """Return the values of XKF4 after its instance."""
    health = sample.health
    if health is None:
        return (0, 0, 0, 0, 0, 0.0, 0.0, 0.0, 0, 0, _SOLUTION, 0, 0)
    ratios = (
        health.velocity_variance,
        health.position_variance,
        health.height_variance,
        health.compass_variance,
    )
    solution = _SOLUTION if health.horizontal else _WITHOUT_POSITION
    return (*(to_int(ratio * 100) for ratio in ratios), 0, 0.0, 0.0, 0.0, 0, 0, solution, 0, 0)


def _airspeed(sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
    """Return the values of ARSP."""
    pressure = sample.sensors.differential_pressure * 100
    temperature = to_int(sample.sensors.temperature * 100)
    return (sample.time_us, 0, sample.airspeed, pressure, temperature, pressure, 0.0, 1, 1, 1.0, 0.0, 0)


def _scaled(value: float, factor: float) -> float:
    """Return a number for an integer field; `Block` clips it to the field."""
    scaled = value * factor
    return round(scaled) if abs(scaled) < 1e18 else scaled


def _is_hexadecimal(text: str) -> bool:
    """Return whether a text is hexadecimal."""
    return bool(text) and all(letter in "0123456789abcdefABCDEF" for letter in text)
