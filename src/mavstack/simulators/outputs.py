"""The outputs of firmwares, as the actuators of a body.

| outputs | actuators | ArduPilot's servo outputs | PX4's HIL_ACTUATOR_CONTROLS |
|---|---|---|---|
| MOTORS | each output, 0 to 1 | 1000 to 2000 µs | as they are |
| SURFACES | aileron, elevator (up), throttle, rudder | 1, 2, 3, 4 | 0, 1, 2, 3 |
| VTOL | as SURFACES, then four motors | 1 to 4, 5 to 8 | motors 0 to 3, then 4, 5, 6, 7 (see below) |
| STEERING | steering (right), throttle | 1, 3 | 0, 1 |
| THRUSTERS | each output, -1 to 1 | 1100 to 1900 µs | as they are |

With PX4 a VTOL has throttle, aileron, elevator and rudder at 4 to 7. The order of SURFACES, VTOL and STEERING
is the order of the airframe's output functions (HIL_ACT_FUNCn). Betaflight drives four motors, 0 to 1.
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Servo pulses in microseconds: lowest, centre; and the pulse of an output that is off.
_LOWEST, _CENTER, _OFF = 1000.0, 1500.0, 0
#: Maximum difference of a thruster's pulse from the centre, in microseconds.
_THRUSTER_TRAVEL: Final = 400.0
_HALF: Final = 500.0
#: Number of lifting motors of a VTOL, and the indexes of aileron, elevator, throttle and rudder in PX4's
#: outputs.
_LIFTERS: Final = 4
_PX4_VTOL: Final = (5, 6, 4, 7)


class Outputs(Enum):
    """How outputs become actuators; see the module."""

    MOTORS = "motors"
    SURFACES = "surfaces"
    VTOL = "vtol"
    STEERING = "steering"
    THRUSTERS = "thrusters"

    def of_pulses(self, pulses: Sequence[int]) -> tuple[float, ...]:
        """Return the actuators of ArduPilot's servo outputs (microseconds); one that is off is neutral."""
        if self is Outputs.MOTORS:
            return tuple([_share(pulse) for pulse in pulses])
        if self is Outputs.THRUSTERS:
            return tuple([_centered(pulse) * _HALF / _THRUSTER_TRAVEL for pulse in pulses])
        if self is Outputs.STEERING:
            return _centered(pulses[0]), _centered(pulses[2])
        surfaces = (_centered(pulses[0]), _centered(pulses[1]), _share(pulses[2]), _centered(pulses[3]))
        if self is Outputs.SURFACES:
            return surfaces
        return surfaces + tuple([_share(pulse) for pulse in pulses[4 : 4 + _LIFTERS]])

    def of_controls(self, controls: Sequence[float]) -> tuple[float, ...]:
        """Return the actuators of PX4's HIL_ACTUATOR_CONTROLS; NaN, an output not driven, is neutral."""
        known = tuple([value if value == value else 0.0 for value in controls])
        if self is Outputs.MOTORS or self is Outputs.THRUSTERS:
            return known
        if self is Outputs.VTOL:
            return tuple([known[index] for index in _PX4_VTOL]) + known[:_LIFTERS]
        return known[: 4 if self is Outputs.SURFACES else 2]


def _share(pulse: int) -> float:
    return max(pulse - _LOWEST, 0.0) / 1000.0


def _centered(pulse: int) -> float:
    return (pulse - _CENTER) / _HALF if pulse != _OFF else 0.0
