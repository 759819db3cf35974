"""ArduPilot's logs (.BIN): records behind a head of three bytes, each kind described by FMT and FMTU.

Each sample writes what the vehicle does: ATT, POS, IMU, XKF1. Each fifth of a second it writes what changes
slower: GPS, GPA, BARO, BAT, MAG, RCIN, RCOU, XKF4, and ARSP if there is air speed. The rest is written when
it happens.
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

#: Between two records of what changes slowly.
SLOW_US = 200_000
#: LogEvent of arming, and so on; more are in the firmware's list.
EVENT_ARMED, EVENT_DISARMED, EVENT_LANDED, EVENT_NOT_LANDED, EVENT_SET_HOME = 10, 11, 18, 28, 25
_GPS_EPOCH, _LEAP_SECONDS, _WEEK_MS = 315_964_800, 18, 604_800_000
_CHANNELS = 14
_EKF3 = 3
#: How the estimate is: attitude, velocities, positions relative and absolute; and without a position.
_SOLUTION, _WITHOUT_POSITION = 0x33F, 0x0A7
_FAST = ("ATT", "POS", "IMU", "XKF1")
_SLOW = ("GPS", "GPA", "BARO", "BAT", "MAG", "RCIN", "RCOU", "XKF4")


def _block(*names: str) -> Block:
    return Block("".join("3s" + FORMATS[name].codes for name in names))


_RECORDS = {name: (FORMATS[name].head, _block(name)) for name in FORMATS}
_FAST_BLOCK, _SLOW_BLOCK = _block(*_FAST), _block(*_SLOW)
_ATT, _POS, _IMU, _XKF1 = (FORMATS[name].head for name in _FAST)
_GPS, _GPA, _BARO, _BAT, _MAG, _RCIN, _RCOU, _XKF4 = (FORMATS[name].head for name in _SLOW)


def _record(name: str, *values: Scalar) -> bytes:
    head, block = _RECORDS[name]
    return block.pack_values(head, *values)


class DataflashWriter:
    """Writes one log into `data`, which whoever keeps it may empty from time to time."""

    def __init__(self, start: LogStart, time_us: int) -> None:
        self.data = bytearray(_formats(time_us))
        self._start = start
        self._slow_at = time_us
        self._ground: float | None = None
        self._energy = 0.0
        self._last_us = time_us
        self._write_start(time_us)

    # While it goes on

    def write(self, sample: FlightSample) -> None:
        """Write a sample."""
        self.data += _FAST_BLOCK.pack(self._fast, sample)
        if sample.time_us >= self._slow_at:
            self._slow_at = sample.time_us + SLOW_US
            self.data += _SLOW_BLOCK.pack(self._slow, sample)
            if sample.airspeed != 0.0:
                head, block = _RECORDS["ARSP"]
                self.data += block.pack(lambda of, whole: (head, *_airspeed(of, whole)), sample)

    def text(self, time_us: int, severity: int, text: str) -> None:
        """Write what the vehicle says to people."""
        self._put("MSG", time_us, text_of(text, 64))

    def mode(self, time_us: int, mode: int, reason: int = 0) -> None:
        """Write that the mode is another."""
        self._put("MODE", time_us, mode & 0xFF, mode & 0xFF, reason)

    def armed(self, time_us: int, armed: bool, *, forced: bool = False, method: int = 0) -> None:
        """Write that the motors were armed or disarmed."""
        self._put("ARM", time_us, armed, 0, forced, method)
        self.event(time_us, EVENT_ARMED if armed else EVENT_DISARMED)

    def event(self, time_us: int, event: int) -> None:
        """Write one of the firmware's numbered events."""
        self._put("EV", time_us, event)

    def error(self, time_us: int, subsystem: int, code: int) -> None:
        """Write that a subsystem failed, or with code 0 that it works again."""
        self._put("ERR", time_us, subsystem, code)

    def parameter(self, time_us: int, name: str, value: Value, default: Value | None = None) -> None:
        """Write a parameter."""
        self._put(
            "PARM", time_us, text_of(name, 16), float(value), float(value if default is None else default)
        )

    def command(self, time_us: int, item: MissionItem, sequence: int, total: int) -> None:
        """Write an item of the mission, as it is begun."""
        scale = scale_of(item.command, item.frame)
        x, y = to_integer(item.param5, scale), to_integer(item.param6, scale)
        params = (item.param1, item.param2, item.param3, item.param4)
        self._put("CMD", time_us, total, sequence, item.command, *params, x, y, item.param7, item.frame)

    def home(self, time_us: int, latitude: float, longitude: float, altitude: float) -> None:
        """Write that home is there."""
        self._place(time_us, 1, latitude, longitude, altitude)

    # How it begins

    def _write_start(self, time_us: int) -> None:
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
        self._place(time_us, 0, *start.origin)
        if start.home is not None:
            self.home(time_us, *start.home)

    def _place(self, time_us: int, kind: int, latitude: float, longitude: float, altitude: float) -> None:
        self._put(
            "ORGN", time_us, kind, _scaled(latitude, 1e7), _scaled(longitude, 1e7), _scaled(altitude, 1e2)
        )

    def _put(self, name: str, *values: Scalar) -> None:
        self.data += _record(name, *values)

    # What a sample holds

    def _fast(self, sample: FlightSample, whole: Rounding) -> tuple[Scalar, ...]:
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
            _POS, time, whole(sample.latitude * 1e7), whole(sample.longitude * 1e7), sample.altitude,
            sample.altitude - sample.home_altitude, up,
            _IMU, time, 0, sensors.gyro_x, sensors.gyro_y, sensors.gyro_z, sensors.acceleration_x,
            sensors.acceleration_y, sensors.acceleration_z, 0, 0, sensors.temperature, 1, 1, 1000, 1000,
            _XKF1, time, 0, whole(roll * 100), whole(pitch * 100), whole(yaw * 100), motion.velocity_north,
            motion.velocity_east, motion.velocity_down, motion.velocity_down, motion.north, motion.east,
            motion.down, 0, 0, 0, whole((sample.altitude - up) * 100),
        )  # fmt: skip

    def _slow(self, sample: FlightSample, whole: Rounding) -> tuple[Scalar, ...]:
        time = sample.time_us
        return (
            *self._receiver(sample, whole),
            *self._barometer(sample, whole),
            *self._battery(sample, whole),
            _MAG, time, 0, whole(sample.sensors.magnetic_x * 1e3), whole(sample.sensors.magnetic_y * 1e3),
            whole(sample.sensors.magnetic_z * 1e3), 0, 0, 0, 0, 0, 0, 1, time & 0xFFFFFFFF,
            _RCIN, time, *channels(sample.rc, _CHANNELS, whole),
            _RCOU, time, *channels(sample.servos, _CHANNELS, whole),
            _XKF4, time, 0, *_variances(sample, whole),
        )  # fmt: skip

    def _receiver(self, sample: FlightSample, whole: Rounding) -> tuple[Scalar, ...]:
        sensors, time = sample.sensors, sample.time_us
        north, east = sensors.gps_velocity_north, sensors.gps_velocity_east
        moment = whole((self._start.boot - _GPS_EPOCH + _LEAP_SECONDS) * 1e3 + time / 1e3)
        accuracy = (whole(sensors.gps_eph * 100), whole(sensors.gps_epv * 100))
        altitude = whole(sensors.gps_altitude * 100)
        return (
            _GPS, time, 0, sensors.gps_fix, moment % _WEEK_MS, moment // _WEEK_MS, sensors.gps_satellites,
            whole(sensors.gps_eph * 100), whole(sensors.gps_latitude * 1e7),
            whole(sensors.gps_longitude * 1e7), altitude, hypot(north, east),
            degrees(atan2(east, north)) % 360, sensors.gps_velocity_down, 0.0, 1,
            _GPA, time, 0, accuracy[1], *accuracy, 20, 0.0, 1, time // 1000 & 0xFFFFFFFF, 200, altitude, 0, 0,
        )  # fmt: skip

    def _barometer(self, sample: FlightSample, whole: Rounding) -> tuple[Scalar, ...]:
        sensors, time = sample.sensors, sample.time_us
        height, pressure = pressure_altitude(sensors.pressure), sensors.pressure * 100
        if self._ground is None:
            self._ground = height + min(sample.motion.down, 0.0)
        return (
            _BARO, time, 0, height - self._ground, height, pressure, whole(sensors.temperature * 100),
            -sample.motion.velocity_down, time // 1000 & 0xFFFFFFFF, 0.0, sensors.temperature, 1, pressure,
        )  # fmt: skip

    def _battery(self, sample: FlightSample, whole: Rounding) -> tuple[Scalar, ...]:
        battery, time = sample.battery, sample.time_us
        hours = max(time - self._last_us, 0) / 3.6e9
        self._last_us = max(time, self._last_us)
        energy = battery.voltage * battery.current * hours
        self._energy += 0.0 if isnan(energy) else energy
        return (
            _BAT, time, 0, battery.voltage, battery.voltage, battery.current, battery.consumed, self._energy,
            whole(battery.temperature * 100), 0.0, whole(battery.remaining * 100), 1, 100,
        )  # fmt: skip


def _formats(time_us: int) -> bytes:
    """All formats, units and multipliers."""
    formats = [
        _record(
            "FMT",
            kind.type,
            kind.length,
            kind.name.encode(),
            kind.format.encode(),
            kind.labels.encode(),
        )
        for kind in FORMATS.values()
    ]
    units = [_record("UNIT", time_us, ord(letter), name.encode()) for letter, name in UNITS.items()]
    factors = [_record("MULT", time_us, ord(letter), factor) for letter, factor in MULTIPLIERS.items()]
    meanings = [
        _record("FMTU", time_us, kind.type, kind.units.encode(), kind.multipliers.encode())
        for kind in FORMATS.values()
    ]
    return b"".join((*formats, *units, *factors, *meanings))


def _variances(sample: FlightSample, whole: Rounding) -> tuple[Scalar, ...]:
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
    return (*(whole(ratio * 100) for ratio in ratios), 0, 0.0, 0.0, 0.0, 0, 0, solution, 0, 0)


def _airspeed(sample: FlightSample, whole: Rounding) -> tuple[Scalar, ...]:
    pressure = sample.sensors.differential_pressure * 100
    temperature = whole(sample.sensors.temperature * 100)
    return (sample.time_us, 0, sample.airspeed, pressure, temperature, pressure, 0.0, 1, 1, 1.0, 0.0, 0)


def _scaled(value: float, factor: float) -> float:
    """A number for an integer field; Block makes what is no number of it fit."""
    scaled = value * factor
    return round(scaled) if abs(scaled) < 1e18 else scaled


def _is_hexadecimal(text: str) -> bool:
    return bool(text) and all(letter in "0123456789abcdefABCDEF" for letter in text)
