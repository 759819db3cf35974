"""The outputs of firmwares, as the actuators of a body.

| outputs | actuators | ArduPilot's servo outputs | PX4's HIL_ACTUATOR_CONTROLS |
|---|---|---|---|
| MOTORS | each output, 0 to 1 | 1000 to 2000 µs | as they are |
| SURFACES | aileron, elevator (up), throttle, rudder | 1, 2, 3, 4 | 0, 1, 2, 3 |
| STEERING | steering (right), throttle | 1, 3 | 0, 1 |
| THRUSTERS | each output, -1 to 1 | 1100 to 1900 µs | as they are |

With PX4 the order of SURFACES and STEERING is that of the airframe's output functions (HIL_ACT_FUNCn).
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Servo pulses in microseconds: lowest, centre; and that of an output that is off.
_LOWEST, _CENTER, _OFF = 1000.0, 1500.0, 0
#: Half the travel of a thruster, in microseconds.
_THRUSTER_TRAVEL: Final = 400.0
_HALF: Final = 500.0


class Outputs(Enum):
    """How outputs become actuators; see the module."""

    MOTORS = "motors"
    SURFACES = "surfaces"
    STEERING = "steering"
    THRUSTERS = "thrusters"

    def of_pulses(self, pulses: Sequence[int]) -> tuple[float, ...]:
        """Return the actuators of ArduPilot's servo outputs (microseconds); one that is off is neutral."""
        if self is Outputs.MOTORS:
            return tuple((max(pulse, _LOWEST) - _LOWEST) / 1000.0 for pulse in pulses)
        if self is Outputs.THRUSTERS:
            return tuple(_centered(pulse) * _HALF / _THRUSTER_TRAVEL for pulse in pulses)
        if self is Outputs.STEERING:
            return _centered(pulses[0]), _centered(pulses[2])
        throttle = max(pulses[2] - _LOWEST, 0.0) / 1000.0
        return _centered(pulses[0]), _centered(pulses[1]), throttle, _centered(pulses[3])

    def of_controls(self, controls: Sequence[float]) -> tuple[float, ...]:
        """Return the actuators of PX4's HIL_ACTUATOR_CONTROLS; NaN, an output not driven, is neutral."""
        if self is Outputs.MOTORS or self is Outputs.THRUSTERS:
            return tuple([value if value == value else 0.0 for value in controls])
        count = 4 if self is Outputs.SURFACES else 2
        return tuple([value if value == value else 0.0 for value in controls[:count]])


def _centered(pulse: int) -> float:
    return (pulse - _CENTER) / _HALF if pulse != _OFF else 0.0
