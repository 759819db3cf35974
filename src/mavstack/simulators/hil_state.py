"""ArduPilot's hardware in the loop: HIL_STATE to the board, its outputs back. Sans-IO.

ArduPlane and Rover up to 4.0 that are built with HIL (`HIL_MODE` 1) take position, attitude and inertial
sensors from HIL_STATE and report their outputs by RC_CHANNELS_SCALED (roll, pitch, throttle, rudder; steering
first for a rover). Later versions have no such interface, copters never had it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, cast

from mavstack.dialects import common
from mavstack.rotation import to_euler
from mavstack.simulators.outputs import Outputs
from mavstack.simulators.state import GRAVITY
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from mavstack.dialects import Dialect
    from mavstack.simulators.sensors import SensorSource
    from mavstack.simulators.state import State

_SCALED: Final = common.RcChannelsScaled.__mavlink_row__[0]
_FULL: Final = 10_000.0
_SYSTEM, _COMPONENT = 255, 190


class HilStateInterface:
    """The conversation with a board that runs ArduPilot with HIL.

    Args:
        dialect: The dialect of its messages.
        sensors: The sensors of the body.

    Attributes:
        controls: The outputs: aileron, elevator, throttle, rudder, or steering and throttle.
        answers: Packets of outputs that were received.
    """

    def __init__(self, dialect: Dialect, sensors: SensorSource) -> None:
        self._sensors = sensors
        self._parser = Parser(dialect)
        self._encoder = Encoder(system=_SYSTEM, component=_COMPONENT)
        self._last = (0.0, 0.0, 0.0, 0.0)
        self.answers = 0

    def feed(self, data: bytes) -> bool:
        """Take bytes of the board; returns True if they contain outputs."""
        is_new = False
        for packet in self._parser.feed(data):
            if packet.message_id == _SCALED:
                message = cast("common.RcChannelsScaled", packet.message)
                self._last = (
                    message.chan1_scaled / _FULL,
                    message.chan2_scaled / _FULL,
                    message.chan3_scaled / _FULL,
                    message.chan4_scaled / _FULL,
                )
                self.answers += 1
                is_new = True
        return is_new

    def actuators(self, outputs: Outputs) -> tuple[float, ...]:
        """Return the actuators of a body."""
        roll, pitch, throttle, rudder = self._last
        if outputs is Outputs.STEERING:
            return roll, throttle
        return roll, pitch, max(throttle, 0.0), rudder

    def step(self, state: State, time: float) -> bytes:
        """Return the packet of a step at a time in seconds."""
        readings = self._sensors.sample(state, time)
        roll, pitch, yaw = to_euler(state.attitude)
        latitude, longitude, altitude = self._sensors.true_place(state)
        north, east, down = state.velocity
        p, q, r = readings.rates
        ax, ay, az = readings.acceleration
        scale = 1000.0 / GRAVITY
        return self._encoder.encode(
            common.HilState(
                time_usec=round(time * 1e6),
                roll=roll,
                pitch=pitch,
                yaw=yaw,
                rollspeed=p,
                pitchspeed=q,
                yawspeed=r,
                lat=round(latitude * 1e7),
                lon=round(longitude * 1e7),
                alt=round(altitude * 1e3),
                vx=_short(100.0 * north),
                vy=_short(100.0 * east),
                vz=_short(100.0 * down),
                xacc=_short(scale * ax),
                yacc=_short(scale * ay),
                zacc=_short(scale * az),
            )
        )


def _short(value: float) -> int:
    return max(-32768, min(32767, round(value)))
