"""The profile of satellite links: HIGH_LATENCY2, made from the full stream, instead of telemetry.

`HighLatency` is a filter between the router and one link, without input, output or clock. Of the packets for
the link it keeps the newest message of each kind that a summary needs, and passes on only packets that a
person or a program behind the link waits for: those addressed to it, acknowledgements, status texts from
warning up, and parameters that it asked for. Every `interval` seconds it makes one HIGH_LATENCY2 of each
autopilot, from that autopilot's ids, so that ground stations take it for the vehicle's own.

The scaling is that of the firmwares: PX4 puts the main and the sub mode, the upper half of its custom mode,
into the 16 bits of the field, and the direction to which the wind blows; ArduPilot its mode number, the
direction from which the wind blows, and the base mode of HEARTBEAT, which tells whether the vehicle is armed,
into `custom0`. Of the climb rate the largest since the last message counts. Unknown values are those of PX4:
-1 for the battery, the largest value for accuracies and the mission item, the smallest for the temperature.
"""

from __future__ import annotations

from math import atan2, degrees, hypot, isfinite
from typing import TYPE_CHECKING, Final, TypeVar

from mavstack.dialects import ardupilotmega, common
from mavstack.services import message_ids
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from mavstack.dialects import Dialect, Message
    from mavstack.wire import Packet

Kind = TypeVar("Kind", bound="Message")

#: Seconds after the last heartbeat of an autopilot for which HIGH_LATENCY2 is sent for it.
VEHICLE_TIMEOUT: Final = 30.0
#: Seconds after a parameter request for which PARAM_VALUE is forwarded.
PARAMETER_TIMEOUT: Final = 10.0
MAX_VEHICLES: Final = 255

_INT8: Final = (-128, 127)
_UINT8: Final = (0, 255)
_INT16: Final = (-32_768, 32_767)
_UINT16: Final = (0, 65_535)
_UNKNOWN_HEADING: Final = 65_535
_NO_BATTERY: Final = -1
_UNKNOWN_CUSTOM: Final = -128

_SOURCE_CLASSES: Final = (
    common.GlobalPositionInt,
    common.VfrHud,
    common.NavControllerOutput,
    common.PositionTargetGlobalInt,
    ardupilotmega.Wind,
    common.WindCov,
    common.GpsRawInt,
    common.ScaledPressure,
    common.SysStatus,
    common.BatteryStatus,
    common.MissionCurrent,
    common.SystemTime,
)
_SOURCES: Final = message_ids(*_SOURCE_CLASSES)
_HEARTBEAT: Final = message_ids(common.Heartbeat)
_PARAMETER_VALUE: Final = message_ids(common.ParamValue)
_PARAMETER_REQUESTS: Final = message_ids(common.ParamRequestRead, common.ParamSet)
_COMMAND_ACK: Final = message_ids(common.CommandAck)
_Sensor, _Failure = common.MavSysStatusSensor, common.HlFailureFlag
_FAILURES: Final = {
    _Sensor.SENSOR_GPS: _Failure.GPS,
    _Sensor.SENSOR_DIFFERENTIAL_PRESSURE: _Failure.DIFFERENTIAL_PRESSURE,
    _Sensor.SENSOR_ABSOLUTE_PRESSURE: _Failure.ABSOLUTE_PRESSURE,
    _Sensor.SENSOR_3D_ACCEL: _Failure._3D_ACCEL,  # noqa: SLF001 (a name that begins with a digit)
    _Sensor.SENSOR_3D_GYRO: _Failure._3D_GYRO,  # noqa: SLF001
    _Sensor.SENSOR_3D_MAG: _Failure._3D_MAG,  # noqa: SLF001
    _Sensor.TERRAIN: _Failure.TERRAIN,
    _Sensor.SENSOR_BATTERY: _Failure.BATTERY,
    _Sensor.SENSOR_RC_RECEIVER: _Failure.RC_RECEIVER,
    _Sensor.SENSOR_MOTOR_OUTPUTS: _Failure.ENGINE,
    _Sensor.GEOFENCE: _Failure.GEOFENCE,
    _Sensor.AHRS: _Failure.ESTIMATOR,
}


class HighLatency:
    """The profile of one link.

    Args:
        dialect: The dialect of the packets.
        interval: Seconds between two summaries of a vehicle.
    """

    def __init__(self, dialect: Dialect, interval: float) -> None:
        self._interval = interval
        self._parser = Parser(dialect)
        self._requests = Parser(dialect)
        self._vehicles: dict[tuple[int, int], _Vehicle] = {}
        self._parameters_until = 0.0
        self._due: float | None = None

    def receive(self, data: bytes, now: float) -> list[bytes]:
        """Take packets of the full stream for the link.

        Args:
            data: The bytes of one or several packets.
            now: Time in seconds; it never decreases.

        Returns:
            The packets that pass unchanged.
        """
        return [packet.raw for packet in self._parser.feed(data) if self._passes(packet, now)]

    def receive_request(self, data: bytes, now: float) -> None:
        """Take bytes that came from the link, to learn which answers it waits for."""
        for packet in self._requests.feed(data):
            if packet.message_id in _PARAMETER_REQUESTS:
                self._parameters_until = now + PARAMETER_TIMEOUT

    def messages_to_send(self, now: float) -> list[bytes]:
        """Return the summaries that are due, as packets from the autopilots' ids."""
        if self._due is None or now < self._due:
            return []
        self._due = now + self._interval
        self._vehicles = {
            key: each for key, each in self._vehicles.items() if now - each.last_heard <= VEHICLE_TIMEOUT
        }
        if not self._vehicles:
            self._due = None
        return [each.encoded_summary() for each in self._vehicles.values()]

    def next_timeout(self) -> float | None:
        """Return when `messages_to_send` has something next; None: when a vehicle appears."""
        return self._due

    def _passes(self, packet: Packet, now: float) -> bool:
        """Return whether a packet passes unchanged; keep it if a summary needs it."""
        key = packet.system, packet.component
        number = packet.message_id
        if number in _HEARTBEAT:
            self._keep_heartbeat(key, packet.message, now)
            return False
        if number in _SOURCES:
            if key in self._vehicles:
                self._vehicles[key].keep(packet.message)
            return False
        if number in _PARAMETER_VALUE:
            return now < self._parameters_until
        if number in _COMMAND_ACK:
            return True
        message = packet.message
        if isinstance(message, common.Statustext):
            return bool(message.severity <= common.MavSeverity.WARNING)
        return bool(getattr(message, "target_system", 0))

    def _keep_heartbeat(self, key: tuple[int, int], message: object, now: float) -> None:
        if not isinstance(message, common.Heartbeat) or message.autopilot == common.MavAutopilot.INVALID:
            return
        if key not in self._vehicles:
            if len(self._vehicles) >= MAX_VEHICLES:
                return
            self._vehicles[key] = _Vehicle(*key)
            # Send the first summary after a second: by then the other messages of a new vehicle have arrived.
            self._due = min(self._due if self._due is not None else now + 1.0, now + self._interval)
        vehicle = self._vehicles[key]
        vehicle.last_heard = now
        vehicle.heartbeat = message


class _Vehicle:
    """The newest messages of one autopilot."""

    def __init__(self, system: int, component: int) -> None:
        self._encoder = Encoder(system, component)
        self._newest: dict[type[Message], Message] = {}
        self._batteries: dict[int, int] = {}
        self._climb_rate = 0.0
        self.heartbeat = common.Heartbeat()
        self.last_heard = 0.0

    def keep(self, message: Message) -> None:
        """Keep a message as the newest of its kind."""
        self._newest[_kind(message)] = message
        if isinstance(message, common.VfrHud) and abs(message.climb) > abs(self._climb_rate):
            self._climb_rate = message.climb
        elif isinstance(message, common.BatteryStatus):
            self._batteries[message.id] = message.battery_remaining

    def encoded_summary(self) -> bytes:
        """Return the packet of a HIGH_LATENCY2 from the messages kept."""
        packet = self._encoder.encode(self._summary())
        self._climb_rate = 0.0
        return packet

    def _latest(self, kind: type[Kind]) -> Kind | None:
        found = self._newest.get(kind)
        return found if isinstance(found, kind) else None

    def _summary(self) -> common.HighLatency2:
        heartbeat = self.heartbeat
        is_px4 = heartbeat.autopilot == common.MavAutopilot.PX4
        is_ardupilot = heartbeat.autopilot == common.MavAutopilot.ARDUPILOTMEGA
        mode = heartbeat.custom_mode
        base_mode = int(heartbeat.base_mode)
        signed_base_mode = base_mode - 256 if base_mode > _INT8[1] else base_mode
        current = self._latest(common.MissionCurrent)
        position = self._latest(common.GlobalPositionInt) or common.GlobalPositionInt(hdg=_UNKNOWN_HEADING)
        speeds = self._latest(common.VfrHud) or common.VfrHud()
        heading = position.hdg / 100 if position.hdg != _UNKNOWN_HEADING else speeds.heading
        altitude = position.alt / 1000
        wind_speed, wind_direction = self._wind(blows_to=is_px4)
        horizontal, vertical = self._accuracies()
        target = self._target(altitude, speeds.airspeed)
        return common.HighLatency2(
            timestamp=self._time_boot(),
            type=heartbeat.type,
            autopilot=heartbeat.autopilot,
            custom_mode=mode >> 16 if is_px4 else mode & _UINT16[1],
            latitude=position.lat,
            longitude=position.lon,
            altitude=_limited(altitude, _INT16),
            target_altitude=_limited(target[0], _INT16),
            heading=_half_degrees(heading),
            target_heading=_half_degrees(target[1]),
            target_distance=_limited(target[2] / 10, _UINT16),
            throttle=_limited(speeds.throttle, (0, 100)),
            airspeed=_limited(speeds.airspeed * 5, _UINT8),
            airspeed_sp=_limited(target[3] * 5, _UINT8),
            groundspeed=_limited(speeds.groundspeed * 5, _UINT8),
            windspeed=_limited(wind_speed * 5, _UINT8),
            wind_heading=_half_degrees(wind_direction),
            eph=horizontal,
            epv=vertical,
            temperature_air=self._temperature(),
            climb_rate=_limited(self._climb_rate * 10, _INT8),
            battery=self._battery(),
            wp_num=current.seq if current is not None else _UINT16[1],
            failure_flags=self._failures(),
            custom0=signed_base_mode if is_ardupilot else _UNKNOWN_CUSTOM,
            custom1=0 if is_ardupilot else _UNKNOWN_CUSTOM,
            custom2=0 if is_ardupilot else _UNKNOWN_CUSTOM,
        )

    def _target(self, altitude: float, airspeed: float) -> tuple[float, float, float, float]:
        """Return altitude (m), direction (degrees), distance (m) and airspeed (m/s) of the target."""
        output = self._latest(common.NavControllerOutput)
        setpoint = self._latest(common.PositionTargetGlobalInt)
        target_altitude = setpoint.alt if setpoint is not None else altitude
        if output is None:
            return target_altitude, 0.0, 0.0, 0.0
        if setpoint is None:
            target_altitude = altitude + output.alt_error
        return target_altitude, output.target_bearing, output.wp_dist, airspeed + output.aspd_error

    def _wind(self, *, blows_to: bool) -> tuple[float, float]:
        """Return the speed in m/s and the direction in degrees to or from which the wind blows."""
        covariance, origin = self._latest(common.WindCov), self._latest(ardupilotmega.Wind)
        if covariance is not None:
            to = degrees(atan2(covariance.wind_y, covariance.wind_x))
            speed = hypot(covariance.wind_x, covariance.wind_y)
        elif origin is not None:
            speed, to = origin.speed, origin.direction + 180
        else:
            return 0.0, 0.0
        return speed, to if blows_to else to + 180

    def _accuracies(self) -> tuple[int, int]:
        gps = self._latest(common.GpsRawInt)
        if gps is None:
            return _UINT8[1], _UINT8[1]
        return (
            _limited(gps.h_acc / 100, _UINT8) if gps.h_acc else _UINT8[1],
            _limited(gps.v_acc / 100, _UINT8) if gps.v_acc else _UINT8[1],
        )

    def _temperature(self) -> int:
        """Return the temperature of the air: at the airspeed sensor, which is outside."""
        pressure = self._latest(common.ScaledPressure)
        if pressure is None or not pressure.temperature_press_diff:
            return _INT8[0]
        return _limited(pressure.temperature_press_diff / 100, _INT8)

    def _battery(self) -> int:
        """Return the charge of the emptiest battery in percent, or -1."""
        known = [remaining for remaining in self._batteries.values() if remaining >= 0]
        if known:
            return _limited(min(known), (0, 100))
        status = self._latest(common.SysStatus)
        return _NO_BATTERY if status is None else _limited(status.battery_remaining, (_NO_BATTERY, 100))

    def _failures(self) -> int:
        status = self._latest(common.SysStatus)
        if status is None:
            return 0
        used = int(status.onboard_control_sensors_present) & int(status.onboard_control_sensors_enabled)
        failed = used & ~int(status.onboard_control_sensors_health)
        return sum(int(flag) for sensor, flag in _FAILURES.items() if failed & int(sensor))

    def _time_boot(self) -> int:
        """Return the newest time since boot, in milliseconds."""
        return max((int(getattr(each, "time_boot_ms", 0)) for each in self._newest.values()), default=0)


def _kind(message: Message) -> type[Message]:
    """Return the class of a message, of those that a summary needs; a dialect's own class derives from it."""
    return next((kind for kind in _SOURCE_CLASSES if isinstance(message, kind)), type(message))


def _limited(value: float, limits: tuple[int, int]) -> int:
    """Return a value rounded to the nearest integer within limits; 0 if it is not finite."""
    return min(max(round(value), limits[0]), limits[1]) if isfinite(value) else 0


def _half_degrees(angle: float) -> int:
    """Return an angle in steps of two degrees, from 0 to 179."""
    return int(angle % 360 / 2) if isfinite(angle) else 0
