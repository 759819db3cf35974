"""PX4's side of its HIL interface, for simulated vehicles. Sans-IO.

It connects to a simulator's TCP server, asks for HIL_STATE_QUATERNION, and answers each HIL_SENSOR by one
HIL_ACTUATOR_CONTROLS. The true state of HIL_STATE_QUATERNION is taken if the simulator sends it; without it
the state is estimated from the sensors, as PX4 does.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING, Final, cast

from mavstack.dialects import common
from mavstack.geodesy import LocalFrame
from mavstack.simulators.foreign.estimator import Estimator
from mavstack.simulators.foreign.sample import ForeignSample
from mavstack.simulators.magnetic_model import magnetic_field
from mavstack.simulators.px4 import INERTIAL_BITS, MAGNETIC_BITS
from mavstack.simulators.state import GRAVITY
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.dialects import Dialect

_OUTPUTS, _FIX_3D = 16, 3
#: Seconds between two reports of the true state, which are requested; and the maximum age of a report that is
#: used.
TRUTH_INTERVAL, TRUTH_AGE = 0.005, 0.5
#: The greatest turn rate in rad/s and specific force in m/s2 that a body may have.
MAX_RATE, MAX_FORCE = 500.0, 10_000.0
#: Maximum step in seconds that is integrated.
_MAX_STEP: Final = 0.1


class SidePhase(Enum):
    """The phase of the conversation; its value says what each side waits for."""

    CONNECTING = "the vehicle waits for the simulator's TCP server"
    CONNECTED = "the vehicle waits for the first HIL_SENSOR"
    NO_PLACE = "the vehicle has sensors and waits for a position (HIL_GPS or HIL_STATE_QUATERNION)"
    LOCKSTEP = "the simulator waits for outputs, the vehicle for the next HIL_SENSOR"


class Px4Side:
    """The conversation with one simulator.

    Args:
        dialect: The dialect of its messages.
        system: The system id.

    Attributes:
        phase: The phase; its value says what each side waits for.
        frame: The local frame of the first position; None: there was no position yet.
        steps: HIL_SENSOR messages that were answered.
        problems: What is wrong with the simulator's messages, each once.
    """

    def __init__(self, dialect: Dialect, system: int = 1) -> None:
        self._parser = Parser(dialect)
        self._encoder = Encoder(system=system, component=common.MavComponent.AUTOPILOT1)
        self._estimator = Estimator()
        self._time: int | None = None
        self._truth: common.HilStateQuaternion | None = None
        self._truth_time = 0
        self._declination = 0.0
        self._last = ((0.0, 0.0, -GRAVITY), (0.0, 0.0, 0.0))
        self.phase = SidePhase.CONNECTING
        self.frame: LocalFrame | None = None
        self.steps = 0
        self.problems: set[str] = set()

    def connected(self) -> bytes:
        """Begin: it is connected. Returns what PX4 sends first."""
        self.phase = SidePhase.CONNECTED
        request = common.CommandLong(
            command=common.MavCmd.SET_MESSAGE_INTERVAL,
            param1=float(common.HilStateQuaternion.__mavlink_row__[0]),
            param2=1e6 * TRUTH_INTERVAL,
        )
        heartbeat = common.Heartbeat(
            type=common.MavType.GENERIC, autopilot=common.MavAutopilot.PX4, mavlink_version=3
        )
        return self._encoder.encode(request) + self._encoder.encode(heartbeat)

    def feed(self, data: bytes) -> list[ForeignSample | None]:
        """Take bytes of the simulator.

        Returns:
            A sample for each HIL_SENSOR, each of which needs an answer; None: the position is not known yet.
        """
        samples: list[ForeignSample | None] = []
        for packet in self._parser.feed(data):
            message = packet.message
            if isinstance(message, common.HilSensor):
                if message.id == 0 and self._is_step(message):
                    samples.append(self._step(message))
            elif isinstance(message, common.HilGps):
                self._take_fix(message)
            elif isinstance(message, common.HilStateQuaternion):
                self._take_truth(message)
        return samples

    def answer(self, controls: Sequence[float], *, is_armed: bool) -> bytes:
        """Return the answer to a HIL_SENSOR."""
        self.steps += 1
        outputs = [*controls[:_OUTPUTS], *[0.0] * (_OUTPUTS - len(controls))]
        mode = common.MavModeFlag.CUSTOM_MODE_ENABLED
        if is_armed:
            mode |= common.MavModeFlag.SAFETY_ARMED
        return self._encoder.encode(
            common.HilActuatorControls(time_usec=self._time or 0, controls=outputs, mode=mode, flags=1)
        )

    def _is_step(self, message: common.HilSensor) -> bool:
        """Return whether a HIL_SENSOR has accelerometer and gyroscope, which make a step."""
        if self._time is not None and message.time_usec < self._time:
            self.problems.add("the time of HIL_SENSOR went back")
        if int(message.fields_updated) & INERTIAL_BITS == INERTIAL_BITS:
            return True
        self.problems.add("HIL_SENSOR without accelerometer and gyroscope (fields_updated 0x3f)")
        return False

    def _step(self, message: common.HilSensor) -> ForeignSample | None:
        """Take a HIL_SENSOR; returns None while the position is not known."""
        last, self._time = self._time, message.time_usec
        dt = 0.0 if last is None else min(max(message.time_usec - last, 0) * 1e-6, _MAX_STEP)
        force = (message.xacc, message.yacc, message.zacc)
        rates = (message.xgyro, message.ygyro, message.zgyro)
        if all(abs(each) < MAX_RATE for each in rates) and all(abs(each) < MAX_FORCE for each in force):
            self._estimator.predict(force, rates, dt)
        else:  # too large, or NaN
            self.problems.add("HIL_SENSOR with an impossible acceleration or turn rate")
            force, rates = self._last
        self._last = (force, rates)
        if int(message.fields_updated) & MAGNETIC_BITS == MAGNETIC_BITS:
            self._estimator.take_field((message.xmag, message.ymag, message.zmag), self._declination)
        self.phase = SidePhase.NO_PLACE if self.frame is None else SidePhase.LOCKSTEP
        if self.frame is None:
            return None
        time = message.time_usec * 1e-6
        if self._truth is not None and message.time_usec - self._truth_time < TRUTH_AGE * 1e6:
            return self._of_truth(self.frame, time, rates, force)
        estimate = self._estimator
        return ForeignSample(time, estimate.position, estimate.velocity, estimate.attitude, rates, force)

    def _of_truth(
        self,
        frame: LocalFrame,
        time: float,
        rates: tuple[float, float, float],
        force: tuple[float, float, float],
    ) -> ForeignSample:
        truth = cast("common.HilStateQuaternion", self._truth)
        position = frame.to_local(truth.lat * 1e-7, truth.lon * 1e-7, truth.alt * 1e-3)
        velocity = (truth.vx * 0.01, truth.vy * 0.01, truth.vz * 0.01)
        w, x, y, z = truth.attitude_quaternion
        return ForeignSample(time, position, velocity, (w, x, y, z), rates, force)

    def _take_truth(self, message: common.HilStateQuaternion) -> None:
        length = math.hypot(*message.attitude_quaternion)
        if not abs(length - 1.0) < 0.01:
            self.problems.add("HIL_STATE_QUATERNION whose quaternion is not of length 1")
            return
        self._place(message.lat, message.lon, message.alt)
        self._truth = message
        self._truth_time = self._time or message.time_usec

    def _take_fix(self, message: common.HilGps) -> None:
        if int(message.fix_type) < _FIX_3D:
            return
        frame = self._place(message.lat, message.lon, message.alt)
        position = frame.to_local(message.lat * 1e-7, message.lon * 1e-7, message.alt * 1e-3)
        self._estimator.take_place(position, (message.vn * 0.01, message.ve * 0.01, message.vd * 0.01))

    def _place(self, latitude: int, longitude: int, altitude: int) -> LocalFrame:
        """Return the local frame, which the first position makes."""
        if self.frame is None:
            self.frame = LocalFrame(latitude * 1e-7, longitude * 1e-7, altitude * 1e-3)
            north, east, _ = magnetic_field(latitude * 1e-7, longitude * 1e-7)
            self._declination = math.atan2(east, north)
        return self.frame
