"""ArduPilot's JSON interface: the simulator's side. Sans-IO.

ArduPilot's SITL sends its servo outputs in a datagram to port 9002 (each instance ten more) and waits for the
answer, so both are in lockstep by construction:

| bytes | type | content |
|---|---|---|
| 0 | u16 | 18458: 16 outputs; 29569: 32 outputs |
| 2 | u16 | steps per second |
| 4 | u32 | number of the step |
| 8 | u16 each | pulses in microseconds |

A number that was answered before means that the answer was lost: it is sent again, and nothing moves. A
number that falls back means that SITL was started again: the body is reset. The answer is a line of JSON
without spaces, which SITL's scanner does not accept. Its own models make magnetic field, pressure and
position, from the attitude and position.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.outputs import Outputs
    from mavstack.simulators.physics import Physics
    from mavstack.simulators.sensors import SensorSource

#: The number of outputs, by the magic number at the beginning of a datagram.
_MAGICS: Final = {18458: 16, 29569: 32}
_HEADER: Final = struct.Struct("<HHI")
#: The format of each answer, without spaces because SITL's parser accepts none.
_MOTION: Final = (
    '\n{"timestamp":%.6f,"imu":{"gyro":[%.7g,%.7g,%.7g],"accel_body":[%.7g,%.7g,%.7g]},'
    '"position":[%.9g,%.9g,%.9g],"quaternion":[%.9g,%.9g,%.9g,%.9g],"velocity":[%.9g,%.9g,%.9g]'
)
#: Maximum step in seconds; SITL ignores longer steps.
MAX_STEP: Final = 0.1


@dataclass(frozen=True, slots=True)
class ServoOutputs:
    """One datagram of SITL.

    Attributes:
        rate: Steps per second.
        number: Number of the step.
        pulses: Servo outputs in microseconds, 16 or 32; 0: off.
    """

    rate: int
    number: int
    pulses: tuple[int, ...]

    @classmethod
    def parse(cls, data: bytes) -> ServoOutputs | None:
        """Parse a datagram; None: it is not one of SITL."""
        if len(data) < _HEADER.size:
            return None
        magic, rate, number = _HEADER.unpack_from(data)
        count = _MAGICS.get(magic)
        if count is None or rate == 0 or len(data) != _HEADER.size + 2 * count:
            return None
        return cls(rate, number, struct.unpack_from(f"<{count}H", data, _HEADER.size))


class JsonInterface:
    """The conversation with one ArduPilot.

    Args:
        physics: The body.
        outputs: How servo outputs become its actuators.
        home: The place of position (0, 0, 0), and the heading at the start.
        sensors: Noise and faults of accelerometer and gyroscope.
        on_restart: Called when SITL was started, first or again.

    Attributes:
        state: The state after the last step.
        time: Seconds of the simulation.
        steps: Steps that were made since the last start.
        repeated: Answers that were sent again.
        invalid: Datagrams that are not of SITL.
    """

    def __init__(
        self,
        physics: Physics,
        outputs: Outputs,
        home: Home,
        sensors: SensorSource,
        on_restart: Callable[[], None] = lambda: None,
    ) -> None:
        self._physics, self._outputs, self._home, self._sensors = physics, outputs, home, sensors
        self._speed, self._range = 0.0, math.inf
        self._on_restart = on_restart
        self._number = -1
        self._answer = b""
        self.time = 0.0
        self.steps = self.repeated = self.invalid = 0
        self.state = physics.reset(home, home.heading).checked()

    def is_step(self, data: bytes) -> bool:
        """Return whether the answer to a datagram moves the body."""
        servos = ServoOutputs.parse(data)
        return servos is not None and servos.number != self._number

    def answer(self, data: bytes) -> bytes | None:
        """Make the step that a datagram asks for.

        Args:
            data: The datagram.

        Returns:
            The answer; None: the datagram is not of SITL.
        """
        servos = ServoOutputs.parse(data)
        if servos is None:
            self.invalid += 1
            return None
        if servos.number == self._number:
            self.repeated += 1
            return self._answer
        if servos.number < self._number or self._number < 0:
            self._restart()
        self._number = servos.number
        dt = min(1.0 / servos.rate, MAX_STEP)
        self.state = self._physics.step(self._outputs.of_pulses(servos.pulses), dt).checked()
        self.time += dt
        self.steps += 1
        self._answer = self._line().encode()
        return self._answer

    def _restart(self) -> None:
        # Set the time back too: SITL detects the reset by this.
        self.state = self._physics.reset(self._home, self._home.heading).checked()
        self.time, self.steps = 0.0, 0
        self._sensors.reset()
        self._on_restart()

    def _line(self) -> str:
        state = self.state
        readings = self._sensors.sample(state, self.time)
        line = _MOTION % (
            self.time,
            *readings.rates,
            *readings.acceleration,
            *state.position,
            *state.attitude,
            *state.velocity,
        )
        if state.airspeed is not None:
            self._speed = self._speed if readings.airspeed is None else readings.airspeed
            line += f',"airspeed":{self._speed:.4f}'
        if readings.distance is not None:
            self._range = readings.distance
        if math.isfinite(self._range):
            line += f',"rng_1":{self._range:.4f}'
        if state.battery is not None:
            line += ',"battery":{{"voltage":{:.3f},"current":{:.3f}}}'.format(*readings.battery)
        return line + "}\n"
