"""PX4 in lockstep: the simulator's side of its HIL interface. Sans-IO.

PX4 connects to the simulator's TCP server (port 4560, each instance one more) and then waits: the first
HIL_SENSOR sets its clock, and each one moves it on. Once it drives its outputs it answers each HIL_SENSOR by
one HIL_ACTUATOR_CONTROLS, which ends the step (*lockstep*); before that it answers nothing, so steps go on
without an answer (*start-up*). PX4 does not connect again after a disconnection: both programs are started
again.

    waiting -> connected -> start-up -> lockstep <-> overdue
    any -> closed

Times are those of the simulation and start above 0, since PX4 takes no time of 0. The sensors decide what a
step contains: with the defaults magnetometer and barometer at 50 Hz, a position at 10 Hz.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING, Final, cast

from mavstack.dialects import common
from mavstack.simulators.sensors import MAX_RANGE, MIN_RANGE
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from mavstack.dialects import Dialect, Message
    from mavstack.simulators.sensors import Fix, Flow, Readings, SensorSource
    from mavstack.simulators.state import State

#: Length of a step in microseconds.
STEP: Final = 4_000
#: The time of the first step in microseconds.
START: Final = 1_000_000
#: Steps between two packets of the true state, for PX4's log.
TRUTH_STEPS: Final = 5
#: Bits of HIL_SENSOR.fields_updated for each sensor; PX4 ignores a sensor unless all its bits are set.
INERTIAL_BITS, MAGNETIC_BITS, PRESSURE_BITS, AIRSPEED_BITS = 0x3F, 0x1C0, 0x1A00, 0x400
_CM: Final = 100.0
_UNKNOWN_COURSE: Final = 65535
_SYSTEM, _COMPONENT = 1, 51
_DOWN: Final = 25  # MAV_SENSOR_ROTATION_PITCH_270
_ACTUATORS: Final = common.HilActuatorControls.__mavlink_row__[0]


class Phase(Enum):
    """The phase of a conversation; its value says what each side waits for."""

    WAITING = "the simulator waits for PX4 to connect"
    CONNECTED = "PX4 waits for its first HIL_SENSOR, which sets its clock"
    START_UP = (
        "PX4 starts and does not drive its outputs yet; the simulator sends sensors and waits for no answer"
    )
    LOCKSTEP = "PX4 answers each HIL_SENSOR by one HIL_ACTUATOR_CONTROLS"
    OVERDUE = (
        "the simulator waits for HIL_ACTUATOR_CONTROLS: PX4 is stopped, or a module of it waits for a sensor"
        " that does not come"
    )
    CLOSED = "PX4 disconnected and does not connect again: start both again"


class Px4Interface:
    """The conversation with one PX4.

    Args:
        dialect: The dialect of its messages.
        sensors: The sensors of the body.

    Attributes:
        phase: The phase; its value says what each side waits for.
        time: Time of the last step in microseconds.
        steps: Steps that were sent.
        controls: The outputs of the last answer: motors 0 to 1, others -1 to 1.
        is_armed: The outputs are those of an armed vehicle.
        answers: HIL_ACTUATOR_CONTROLS that were received.
        extra_answers: HIL_ACTUATOR_CONTROLS that no step waited for.
    """

    def __init__(self, dialect: Dialect, sensors: SensorSource) -> None:
        self._sensors = sensors
        self._parser = Parser(dialect)
        self._encoder = Encoder(system=_SYSTEM, component=_COMPONENT)
        self.phase = Phase.WAITING
        self.time = START - STEP
        self.steps = 0
        self.controls: tuple[float, ...] = (0.0,) * 16
        self.is_armed = False
        self.answers = self.extra_answers = 0
        self._is_open = False

    @property
    def seconds(self) -> float:
        """Seconds of the simulation."""
        return self.steps * STEP / 1e6

    def connected(self) -> None:
        """Begin: PX4 has connected."""
        self.phase = Phase.CONNECTED

    def overdue(self) -> None:
        """Note that PX4 does not answer a step."""
        if self.phase is Phase.LOCKSTEP:
            self.phase = Phase.OVERDUE

    def closed(self) -> None:
        """End: PX4 has disconnected."""
        self.phase = Phase.CLOSED

    def feed(self, data: bytes) -> bool:
        """Take bytes of PX4; returns True if they end the step."""
        is_answered = False
        for packet in self._parser.feed(data):
            if packet.message_id == _ACTUATORS:
                self._take_controls(cast("common.HilActuatorControls", packet.message))
                is_answered = True
        return is_answered

    def step(self, state: State) -> bytes:
        """Return the packets of the next step."""
        readings = self._sensors.sample(state, self.seconds)
        self.time += STEP
        self.steps += 1
        self._is_open = True
        if self.phase is Phase.CONNECTED:
            self.phase = Phase.START_UP
        messages: list[Message] = [self._sensor(readings)]
        if readings.fix is not None:
            messages.append(self._fix(readings.fix))
        if readings.distance is not None:
            messages.append(self._distance(readings.distance))
        if readings.flow is not None:
            messages.append(self._flow(readings.flow))
        if self.steps % TRUTH_STEPS == 1:
            messages.append(self._truth(state))
        return b"".join([self._encoder.encode(message) for message in messages])

    def _take_controls(self, message: common.HilActuatorControls) -> None:
        self.extra_answers += not self._is_open
        self._is_open = False
        self.controls = message.controls
        self.is_armed = bool(message.mode & common.MavModeFlag.SAFETY_ARMED)
        self.answers += 1
        self.phase = Phase.LOCKSTEP

    def _sensor(self, readings: Readings) -> common.HilSensor:
        """Return HIL_SENSOR; only samples whose bits are set are new."""
        (ax, ay, az), (p, q, r) = readings.acceleration, readings.rates
        bits, field, altitude = INERTIAL_BITS, readings.magnetic, readings.altitude
        if field is None and altitude is None and readings.airspeed is None:
            return common.HilSensor(
                time_usec=self.time, xacc=ax, yacc=ay, zacc=az, xgyro=p, ygyro=q, zgyro=r, fields_updated=bits
            )
        message = common.HilSensor(time_usec=self.time, xacc=ax, yacc=ay, zacc=az, xgyro=p, ygyro=q, zgyro=r)
        if field is not None:
            message.xmag, message.ymag, message.zmag = field
            bits |= MAGNETIC_BITS
        if altitude is not None:
            self._air(message, altitude)
            bits |= PRESSURE_BITS
        if readings.airspeed is not None:
            message.diff_pressure = self._sensors.atmosphere.dynamic_pressure(
                readings.airspeed, altitude or 0.0
            )
            bits |= AIRSPEED_BITS
        message.fields_updated = bits
        return message

    def _air(self, message: common.HilSensor, altitude: float) -> None:
        air = self._sensors.atmosphere
        message.abs_pressure = air.pressure_at(altitude)
        message.pressure_alt = altitude
        message.temperature = air.temperature_at(altitude)

    def _fix(self, fix: Fix) -> common.HilGps:
        north, east, down = fix.velocity
        speed = math.hypot(north, east)
        course = math.degrees(math.atan2(east, north)) % 360.0
        return common.HilGps(
            time_usec=self.time,
            fix_type=3 if fix.is_valid else 0,
            lat=round(fix.latitude * 1e7),
            lon=round(fix.longitude * 1e7),
            alt=round(fix.altitude * 1e3),
            eph=30 if fix.is_valid else 9999,
            epv=40 if fix.is_valid else 9999,
            vel=round(speed * _CM),
            vn=round(north * _CM),
            ve=round(east * _CM),
            vd=round(down * _CM),
            cog=round(course * _CM) % 36000 if speed > 0.5 else _UNKNOWN_COURSE,
            satellites_visible=12 if fix.is_valid else 0,
        )

    def _distance(self, distance: float) -> common.DistanceSensor:
        is_seen = math.isfinite(distance)
        return common.DistanceSensor(
            time_boot_ms=self.time // 1000,
            min_distance=round(MIN_RANGE * _CM),
            max_distance=round(MAX_RANGE * _CM),
            current_distance=round(distance * _CM) if is_seen else round(MAX_RANGE * _CM) + 1,
            orientation=_DOWN,
            signal_quality=100 if is_seen else 1,
        )

    def _flow(self, flow: Flow) -> common.HilOpticalFlow:
        p, q, r = flow.turn
        is_seen = math.isfinite(flow.distance)
        return common.HilOpticalFlow(
            time_usec=self.time,
            integration_time_us=round(flow.interval * 1e6),
            integrated_x=flow.rates[0] * flow.interval,
            integrated_y=flow.rates[1] * flow.interval,
            integrated_xgyro=p * flow.interval,
            integrated_ygyro=q * flow.interval,
            integrated_zgyro=r * flow.interval,
            quality=flow.quality,
            distance=flow.distance if is_seen else -1.0,
        )

    def _truth(self, state: State) -> common.HilStateQuaternion:
        latitude, longitude, altitude = self._sensors.true_place(state)
        north, east, down = state.velocity
        p, q, r = state.rates
        airspeed = round(_CM * (state.airspeed or 0.0))
        return common.HilStateQuaternion(
            time_usec=self.time,
            attitude_quaternion=state.attitude,
            rollspeed=p,
            pitchspeed=q,
            yawspeed=r,
            lat=round(latitude * 1e7),
            lon=round(longitude * 1e7),
            alt=round(altitude * 1e3),
            vx=round(north * _CM),
            vy=round(east * _CM),
            vz=round(down * _CM),
            ind_airspeed=airspeed,
            true_airspeed=airspeed,
        )
