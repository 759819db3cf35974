"""PX4's onboard logs (.ulg): header, definitions (formats, information, parameters), then records.

Each sample writes attitude, rates, local position and sensors; every 200 ms the global position, GPS,
barometer, battery, radio, outputs, and airspeed if there is any; status, landing and mission every second and
when they change.
"""

from __future__ import annotations

from math import atan2, hypot, isnan
from struct import pack
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.rotation import from_euler
from mavstack.sim.storage.packing import channels, pressure_altitude, text_of
from mavstack.sim.storage.ulog_format import block_of
from mavstack.sim.storage.ulog_topics import TOPICS

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem
    from mavstack.services.parameters import Value
    from mavstack.sim.storage.packing import Rounding, Scalar
    from mavstack.sim.storage.sample import FlightSample, LogStart

#: Intervals of slow records and of status records, in microseconds.
SLOW_INTERVAL_US, STATUS_INTERVAL_US = 200_000, 1_000_000
MAGIC = b"ULog\x01\x12\x35"
SYNC = b"\x2f\x73\x13\x20\x25\x0c\xbb\x12"
_VERSION = 1
_DEFAULT_PARAMETERS = 1
_SYSTEM_DEFAULT, _SETUP_DEFAULT = 1, 2
_AIR_DENSITY = 1.225
_LOW, _CRITICAL, _EMERGENCY = 0.15, 0.07, 0.05
_MAX_TEXT = 127
#: Values for the reasons of arming and disarming.
_BY_COMMAND, _BY_LANDING = 4, 6
#: Speed in m/s above which the vehicle counts as moving.
_MOVING = 0.3
_TYPES = {"I": "uint32_t", "i": "int32_t", "Q": "uint64_t", "f": "float"}

_FAST = block_of(
    *(
        TOPICS[name]
        for name in (
            "vehicle_attitude",
            "vehicle_local_position",
            "sensor_combined",
            "vehicle_angular_velocity",
        )
    )
)
_SLOW = block_of(
    *(
        TOPICS[name]
        for name in (
            "vehicle_global_position",
            "vehicle_gps_position",
            "vehicle_air_data",
            "battery_status",
            "input_rc",
            "actuator_outputs",
        )
    )
)
_STATUS = block_of(*(TOPICS[name] for name in ("vehicle_status", "vehicle_land_detected", "mission_result")))
_AIRSPEED, _HOME, _EVENT = (block_of(TOPICS[name]) for name in ("airspeed", "home_position", "event"))

#: NAVIGATION_STATE by main mode, and by sub mode of AUTO and of POSCTL.
_MAIN = {1: 0, 2: 1, 3: 2, 4: 4, 5: 10, 6: 14, 7: 15, 10: 13, 11: 8}
_AUTO = {2: 17, 3: 4, 4: 3, 5: 5, 6: 18, 8: 19, 9: 20, 10: 22, 19: 7, 20: 12} | {
    11 + number: 23 + number for number in range(8)
}
_POSITION = {1: 21, 2: 6}
_MAIN_AUTO, _MAIN_POSITION = 4, 3

_KIND = common.MavType
_FIXED_WING, _ROTARY_WING, _ROVER = 2, 1, 3
_VEHICLES: dict[int, int] = {
    _KIND.FIXED_WING: _FIXED_WING,
    _KIND.GROUND_ROVER: _ROVER,
    _KIND.SURFACE_BOAT: _ROVER,
}
_VTOL = frozenset(range(_KIND.VTOL_TAILSITTER_DUOROTOR, _KIND.VTOL_TILTWING + 1))


def navigation_state(custom_mode: int) -> int:
    """Return PX4's NAVIGATION_STATE for HEARTBEAT's `custom_mode`."""
    main, sub = custom_mode >> 16 & 0xFF, custom_mode >> 24 & 0xFF
    known = _MAIN.get(main, 0)
    if main == _MAIN_AUTO:
        return _AUTO.get(sub, known)
    return _POSITION.get(sub, known) if main == _MAIN_POSITION else known


class UlogWriter:
    """Writer of one log into `data`, which the caller empties from time to time."""

    def __init__(self, start: LogStart, time_us: int) -> None:
        self.data = bytearray()
        self._start = start
        self._slow_at = self._status_at = time_us
        self._mode = start.mode
        self._mode_us = self._armed_us = self._takeoff_us = 0
        self._status: tuple[Scalar, ...] = ()
        self._events = 0
        self._now = time_us
        self._write_definitions(time_us)
        for topic in TOPICS.values():
            self._put("A", pack("<BH", 0, topic.number) + topic.name.encode())
        self._put("S", SYNC)
        if start.home is not None:
            self.home(time_us, *start.home)

    # Records during the log

    def write(self, sample: FlightSample) -> None:
        """Write a sample."""
        self.data += _FAST.pack(self._fast, sample)
        time = sample.time_us
        if time >= self._slow_at:
            self._slow_at = time + SLOW_INTERVAL_US
            self.data += _SLOW.pack(self._slow, sample)
            if sample.airspeed != 0.0:
                self.data += _AIRSPEED.pack(_airspeed, sample)
        status = (
            sample.mode,
            sample.armed,
            sample.landed,
            sample.failsafe,
            sample.mission_sequence,
            sample.mission_total,
            sample.mission_reached,
        )
        if time >= self._status_at or status != self._status:
            self._note_status_change(status, sample)
            self._status_at = time + STATUS_INTERVAL_US
            self.data += _STATUS.pack(self._state, sample)

    def text(self, time_us: int, severity: int, text: str) -> None:
        """Write a status text."""
        level = ord("0") + min(max(severity, 0), 7)
        self._put("L", pack("<BQ", level, _unsigned(time_us)) + text_of(text, _MAX_TEXT))

    def mode(self, time_us: int, mode: int, reason: int = 0) -> None:
        """Ignore a mode change: the next sample contains it."""

    def armed(self, time_us: int, armed: bool, *, forced: bool = False, method: int = 0) -> None:
        """Ignore arming and disarming: the next sample contains them."""

    def event(self, time_us: int, event: int) -> None:
        """Write one of the firmware's numbered events."""
        self._events += 1
        self.data += _EVENT.pack_values(time_us, event, self._events & 0xFFFF, 0x66)

    def error(self, time_us: int, subsystem: int, code: int) -> None:
        """Ignore numbered errors: PX4 logs failures as text."""

    def parameter(self, time_us: int, name: str, value: Value, default: Value | None = None) -> None:
        """Write a parameter."""
        self._put("P", _parameter(name, value))

    def command(self, time_us: int, item: MissionItem, sequence: int, total: int) -> None:
        """Ignore the start of a mission item: the next sample contains it."""

    def home(self, time_us: int, latitude: float, longitude: float, altitude: float) -> None:
        """Write the home position in degrees and metres AMSL."""
        self.data += _HOME.pack_values(time_us, latitude, longitude, altitude)

    # Start of the log

    def _write_definitions(self, time_us: int) -> None:
        """Write header, formats, information and parameters."""
        start = self._start
        self.data += MAGIC + pack("<BQ", _VERSION, _unsigned(time_us))
        self._put("B", bytes([_DEFAULT_PARAMETERS]) + bytes(39))
        for topic in TOPICS.values():
            self._put("F", topic.description.encode())
        major, minor, patch = (number & 0xFF for number in start.version)
        texts = {
            "ver_sw": start.git_hash,
            "ver_hw": start.board,
            "sys_name": "PX4",
            "sys_os_name": "Linux",
            "sys_uuid": f"{start.system:036x}",
        }
        numbers = {
            "ver_sw_release": ("I", major << 24 | minor << 16 | patch << 8 | 0xFF),
            "ver_data_format": ("I", 2),
            "time_ref_utc": ("i", 0),
            "boot_time_utc_us": ("Q", _unsigned(int(start.boot * 1e6))),
        }
        for name, text in texts.items():
            content = text_of(text, 255)
            self._put("I", _key_value(f"char[{len(content)}]", name, content))
        for name, (code, number) in numbers.items():
            self._put("I", _typed_value(name, code, number))
        for parameter in start.parameters:
            self._put("P", _parameter(parameter.name, parameter.value))
            if parameter.default is not None and parameter.default != parameter.value:
                types = bytes([_SYSTEM_DEFAULT | _SETUP_DEFAULT])
                self._put("Q", types + _parameter(parameter.name, parameter.default))

    def _put(self, kind: str, content: bytes) -> None:
        """Append one message."""
        self.data += pack("<HB", len(content), ord(kind)) + content

    # Values of a sample

    def _note_status_change(self, status: tuple[Scalar, ...], sample: FlightSample) -> None:
        """Store when mode, arming state and flight began."""
        time, last = sample.time_us, self._status
        if not last or last[0] != sample.mode:
            self._mode_us = time
        if sample.armed and not (last and last[1]):
            self._armed_us = time
        if not sample.landed and not (last and not last[2]):
            self._takeoff_us = time
        self._status = status

    def _fast(self, sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
        """Return the values of the topics of each sample."""
        time, motion, sensors, health = sample.time_us, sample.motion, sample.sensors, sample.health
        horizontal = health is None or health.horizontal
        vertical = health is None or health.vertical
        distance = sensors.distance
        latitude, longitude, altitude = self._start.origin
        return (
            time, time, *from_euler(motion.roll, motion.pitch, motion.yaw),
            time, time, time, latitude, longitude, motion.north, motion.east, motion.down,
            motion.velocity_north, motion.velocity_east, motion.velocity_down, motion.velocity_down,
            motion.acceleration_north, motion.acceleration_east, motion.acceleration_down, motion.yaw,
            motion.yaw, altitude, distance, sensors.gps_eph, sensors.gps_epv, horizontal, vertical,
            horizontal, vertical, horizontal, vertical, not isnan(distance), not horizontal,
            time, sensors.gyro_x, sensors.gyro_y, sensors.gyro_z, sensors.acceleration_x,
            sensors.acceleration_y, sensors.acceleration_z,
            time, time, motion.roll_rate, motion.pitch_rate, motion.yaw_rate,
        )  # fmt: skip

    def _slow(self, sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
        """Return the values of the slow topics."""
        time, sensors, battery, health = sample.time_us, sample.sensors, sample.battery, sample.health
        horizontal = health is None or health.horizontal
        vertical = health is None or health.vertical
        height = pressure_altitude(sensors.pressure)
        return (
            time, time, sample.latitude, sample.longitude, sample.altitude, sample.altitude, sensors.gps_eph,
            sensors.gps_epv, sample.home_altitude, horizontal, vertical, not horizontal,
            *self._gps(sample, to_int),
            time, time, height, sensors.pressure * 100, sensors.temperature, _AIR_DENSITY,
            time, battery.voltage, battery.current, battery.current, battery.consumed, battery.remaining,
            battery.temperature, battery.voltage, to_int(battery.cells), _warning(battery.remaining),
            time, time, 100 if sample.rc else 0, *channels(sample.rc, 18, to_int), min(len(sample.rc), 18),
            not sample.rc,
            time, *channels(sample.servos, 16, to_int),
        )  # fmt: skip

    def _gps(self, sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
        """Return the values of vehicle_gps_position."""
        time, sensors = sample.time_us, sample.sensors
        north, east = sensors.gps_velocity_north, sensors.gps_velocity_east
        altitude = sensors.gps_altitude
        return (
            time, time, sensors.gps_latitude, sensors.gps_longitude, altitude, altitude,
            to_int(self._start.boot * 1e6) + time, sensors.gps_eph, sensors.gps_epv, sensors.gps_eph,
            sensors.gps_epv, hypot(north, east), north, east, sensors.gps_velocity_down, atan2(east, north),
            sensors.gps_fix, sensors.gps_fix > 1, sensors.gps_satellites,
        )  # fmt: skip

    def _state(self, sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
        """Return the values of the status topics."""
        time, motion, start = sample.time_us, sample.motion, self._start
        state = navigation_state(sample.mode)
        landed, moving = sample.landed, not sample.landed
        ended = 0 < sample.mission_total <= sample.mission_reached + 1
        return (
            time, self._armed_us if sample.armed else 0, self._takeoff_us if moving else 0, self._mode_us,
            2 if sample.armed else 1, _BY_COMMAND if self._armed_us else 0,
            _BY_LANDING if self._armed_us and not sample.armed else 0,
            state, state, _VEHICLES.get(start.vehicle, _ROTARY_WING), sample.failsafe, start.vehicle in _VTOL,
            start.vehicle, start.system,
            time, landed, landed, landed, landed, abs(motion.velocity_down) > _MOVING,
            hypot(motion.velocity_north, motion.velocity_east) > _MOVING, landed and not sample.armed,
            time, sample.mission_reached, sample.mission_sequence, sample.mission_total,
            sample.mission_total > 0, ended,
        )  # fmt: skip


def _airspeed(sample: FlightSample, to_int: Rounding) -> tuple[Scalar, ...]:
    """Return the values of the airspeed topic."""
    return (sample.time_us, sample.time_us, sample.airspeed, sample.airspeed)


def _warning(remaining: float) -> int:
    """Return the BATTERY_WARNING of a remaining charge."""
    return (remaining < _LOW) + (remaining < _CRITICAL) + (remaining < _EMERGENCY)


def _typed_value(name: str, code: str, value: Value) -> bytes:
    """Return a number with its type and name."""
    return _key_value(_TYPES[code], name, pack("<" + code, value))


def _key_value(kind: str, name: str, content: bytes) -> bytes:
    """Return content with its type and name."""
    key = text_of(f"{kind} {name}", 255)
    return bytes([len(key)]) + key + content


def _parameter(name: str, value: Value) -> bytes:
    """Return a parameter with its type and name."""
    if isinstance(value, int):
        return _typed_value(name, "i", (int(value) + 0x80000000) % 0x100000000 - 0x80000000)
    return _typed_value(name, "f", value if isnan(value) else min(max(value, -1e38), 1e38))


def _unsigned(value: int) -> int:
    """Clip to uint64."""
    return min(max(value, 0), 0xFFFFFFFFFFFFFFFF)
