"""The state of a body, which physics returns and sensors measure."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError
from mavstack.rotation import LEVEL

if TYPE_CHECKING:
    from mavstack.rotation import Quaternion, Vector

#: Standard gravity in m/s2.
GRAVITY = 9.80665
_UNIT_TOLERANCE = 0.01


@dataclass(frozen=True, slots=True)
class State:
    """The state of a body at one time.

    Attributes:
        position: Metres north, east, down of home.
        velocity: Metres per second north, east, down.
        attitude: Unit quaternion (w, x, y, z) from body axes (forward, right, down) to north, east, down.
        rates: Turn rates about the body axes in rad/s.
        specific_force: What an accelerometer measures, in body axes in m/s2: (0, 0, -9.81) at rest and level.
        airspeed: Metres per second through the air; None: it is computed from the velocity, without wind.
        battery: Volts and amperes; None: an ideal battery.
        range: Metres from a downward rangefinder to the ground; None: it is computed from the position.
    """

    position: Vector = (0.0, 0.0, 0.0)
    velocity: Vector = (0.0, 0.0, 0.0)
    attitude: Quaternion = LEVEL
    rates: Vector = (0.0, 0.0, 0.0)
    specific_force: Vector = (0.0, 0.0, -GRAVITY)
    airspeed: float | None = None
    battery: tuple[float, float] | None = None
    range: float | None = None

    def checked(self) -> State:
        """Return this state.

        Raises:
            InvalidArgumentError: A number is not finite, a vector has another length, or the quaternion is
                not of unit length; the text names the field.
        """
        if self._is_plausible():
            return self
        for name, length in (
            ("position", 3),
            ("velocity", 3),
            ("attitude", 4),
            ("rates", 3),
            ("specific_force", 3),
        ):
            values = getattr(self, name)
            if len(values) != length or not all(map(math.isfinite, values)):
                raise InvalidArgumentError(
                    f"the physics returned {name} {tuple(values)}: it must be {length} finite numbers"
                )
        if abs(sum(value * value for value in self.attitude) - 1.0) > _UNIT_TOLERANCE:
            raise InvalidArgumentError(
                f"the physics returned attitude {tuple(self.attitude)}: its length must be 1"
            )
        return self

    def _is_plausible(self) -> bool:
        """Return True if nothing is wrong, faster than the check that finds the reason."""
        try:
            (a, b, c), (d, e, f), (g, h, i) = self.position, self.velocity, self.rates
            (j, k, m), (w, x, y, z) = self.specific_force, self.attitude
        except (TypeError, ValueError):
            return False
        total = a + b + c + d + e + f + g + h + i + j + k + m
        is_finite = total - total == 0.0
        return is_finite and abs(w * w + x * x + y * y + z * z - 1.0) <= _UNIT_TOLERANCE


STATE_FIELDS = tuple(each.name for each in fields(State))
