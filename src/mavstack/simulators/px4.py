"""PX4 in lockstep: the simulator's side of its HIL interface. Sans-IO.

PX4 connects to the simulator's TCP server (port 4560, each instance one more) and then waits: the first
HIL_SENSOR sets its clock, and each one moves it on. Once it drives its outputs it answers each HIL_SENSOR by
one HIL_ACTUATOR_CONTROLS, which ends the step (*lockstep*); before that it answers nothing, so steps go on
without an answer (*start-up*). PX4 does not connect again after a disconnection: both programs are started
again.

    connection: waiting -> start-up -> lockstep

Times are those of the simulation and start above 0, since PX4 takes no time of 0. Magnetometer and barometer
are sent with each 5th step and a position with each 25th: 50 and 10 Hz at steps of 4 ms.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING, Final, cast

from mavstack.dialects import common
from mavstack.simulators.sensors import dynamic_pressure, pressure_at, temperature_at
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from mavstack.dialects import Dialect
    from mavstack.simulators.sensors import Sensors
    from mavstack.simulators.state import State

#: Length of a step in microseconds.
STEP: Final = 4_000
#: The time of the first step in microseconds.
START: Final = 1_000_000
#: Steps between two samples of slower sensors.
SLOW_STEPS, FIX_STEPS, TRUTH_STEPS = 5, 25, 5
#: HIL_SENSOR.fields_updated of each sensor: all bits of a sensor, or PX4 ignores it.
INERTIAL_BITS, MAGNETIC_BITS, PRESSURE_BITS, AIRSPEED_BITS = 0x3F, 0x1C0, 0x1A00, 0x400
_CM: Final = 100.0
_UNKNOWN_COURSE: Final = 65535
_SYSTEM, _COMPONENT = 1, 51


class Phase(Enum):
    """The phase of a conversation: its value is the reason to wait."""

    WAITING = "PX4 is not connected"
    START_UP = "PX4 starts: it does not drive its outputs yet"
    LOCKSTEP = "PX4 answers each step"


class Px4Interface:
    """The conversation with one PX4.

    Args:
        dialect: The dialect of its messages.
        sensors: The sensors of the body.

    Attributes:
        phase: What each side waits for.
        time: Time of the last step in microseconds.
        steps: Steps that were sent.
        controls: The outputs of the last answer: motors 0 to 1, others -1 to 1.
        is_armed: The outputs are those of an armed vehicle.
        answers: HIL_ACTUATOR_CONTROLS that were received.
    """

    def __init__(self, dialect: Dialect, sensors: Sensors) -> None:
        self._sensors = sensors
        self._parser = Parser(dialect)
        self._encoder = Encoder(system=_SYSTEM, component=_COMPONENT)
        self.phase = Phase.WAITING
        self.time = START - STEP
        self.steps = 0
        self.controls: tuple[float, ...] = (0.0,) * 16
        self.is_armed = False
        self.answers = 0

    def connected(self) -> None:
        """Begin: PX4 has connected."""
        self.phase = Phase.START_UP

    def feed(self, data: bytes) -> bool:
        """Take bytes of PX4; returns True if they end the step."""
        is_answered = False
        for packet in self._parser.feed(data):
            if packet.message_id == common.HilActuatorControls.__mavlink_row__[0]:
                self._take_controls(cast("common.HilActuatorControls", packet.message))
                is_answered = True
        return is_answered

    def step(self, state: State) -> bytes:
        """Return what PX4 is sent of the next step."""
        self.time += STEP
        self.steps += 1
        packets = [self._encoder.encode(self._sensor(state))]
        if self.steps % FIX_STEPS == 1:
            packets.append(self._encoder.encode(self._fix(state)))
        if self.steps % TRUTH_STEPS == 1:
            packets.append(self._encoder.encode(self._truth(state)))
        return b"".join(packets)

    def _take_controls(self, message: common.HilActuatorControls) -> None:
        self.controls = message.controls
        self.is_armed = bool(message.mode & common.MavModeFlag.SAFETY_ARMED)
        self.answers += 1
        self.phase = Phase.LOCKSTEP

    def _sensor(self, state: State) -> common.HilSensor:
        sensors = self._sensors
        inertial = sensors.inertial(state)
        (ax, ay, az), (p, q, r) = inertial.acceleration, inertial.rates
        if self.steps % SLOW_STEPS != 1:
            return common.HilSensor(
                time_usec=self.time,
                xacc=ax,
                yacc=ay,
                zacc=az,
                xgyro=p,
                ygyro=q,
                zgyro=r,
                fields_updated=INERTIAL_BITS,
            )
        mx, my, mz = sensors.magnetic(state)
        altitude, airspeed = sensors.altitude(state), sensors.airspeed(state)
        return common.HilSensor(
            time_usec=self.time,
            xacc=ax,
            yacc=ay,
            zacc=az,
            xgyro=p,
            ygyro=q,
            zgyro=r,
            xmag=mx,
            ymag=my,
            zmag=mz,
            abs_pressure=pressure_at(altitude),
            pressure_alt=altitude,
            temperature=temperature_at(altitude),
            diff_pressure=dynamic_pressure(airspeed),
            fields_updated=INERTIAL_BITS | MAGNETIC_BITS | PRESSURE_BITS | AIRSPEED_BITS,
        )

    def _fix(self, state: State) -> common.HilGps:
        fix = self._sensors.fix(state)
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
