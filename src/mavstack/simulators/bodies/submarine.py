"""A submarine from six thrusters as in ArduSub's vectored frame: four at the corners, two vertical ones.

It floats a little, is drawn upright by its buoyancy above its mass, and is slowed by the water linearly and
by the square of its speed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from mavstack.rotation import rotate_back
from mavstack.simulators.rigid_body import RigidBody
from mavstack.simulators.state import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.state import State

#: Mass in kg, including the water that moves with the body; moments of inertia in kg m2.
MASS: Final = 15.0
INERTIA: Final = (0.4, 0.4, 0.5)
#: Full thrust of a thruster, and the buoyancy minus the weight, in newtons.
FULL_THRUST, LIFT = 35.0, 1.5
#: Drag in newtons per m/s, and per (m/s)2, by axis.
DRAG, SQUARE_DRAG = (15.0, 20.0, 30.0), (25.0, 40.0, 60.0)
DAMPING: Final = (1.5, 1.5, 1.5)
#: Righting torque in newton metres per sine of the tilt.
UPRIGHT: Final = 6.0
_LEVER: Final = 0.15
#: For each thruster: factors from its command to roll, yaw, down, forward and right.
_THRUSTERS: Final = (
    (0.0, 1.0, 0.0, -1.0, 1.0),
    (0.0, -1.0, 0.0, -1.0, -1.0),
    (0.0, -1.0, 0.0, 1.0, 1.0),
    (0.0, 1.0, 0.0, 1.0, -1.0),
    (1.0, 0.0, 1.0, 0.0, 0.0),
    (-1.0, 0.0, 1.0, 0.0, 0.0),
)
_SLANT: Final = math.sqrt(0.5)


class Submarine:
    """A submarine of 15 kg that floats up slowly."""

    def __init__(self) -> None:
        self._body = RigidBody(MASS, INERTIA)

    def reset(self, home: Home, heading: float) -> State:
        """Put it at the surface at home; see `Physics`."""
        self._body.place(heading)
        return self._body.state()

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Move it by its thrusters, -1 to 1 each; see `Physics`."""
        body = self._body
        roll = yaw = forward = right = down = 0.0
        for command, part in zip(actuators, _THRUSTERS, strict=False):
            thrust = FULL_THRUST * max(-1.0, min(1.0, command))
            roll += _LEVER * part[0] * thrust
            yaw += _LEVER * part[1] * thrust
            down += part[2] * thrust
            forward += _SLANT * part[3] * thrust
            right += _SLANT * part[4] * thrust
        velocity, rates = body.body_velocity(), body.rates
        water = tuple(
            -(linear + square * abs(value)) * value
            for linear, square, value in zip(DRAG, SQUARE_DRAG, velocity, strict=True)
        )
        up = rotate_back(body.attitude, (0.0, 0.0, -1.0))
        weight = LIFT + MASS * GRAVITY
        force = (
            forward + water[0] + weight * up[0],
            right + water[1] + weight * up[1],
            down + water[2] + weight * up[2],
        )
        # Up x (centre of buoyancy above the centre of mass) gives a torque that rights a rolled body.
        torque = (
            roll + UPRIGHT * up[1] - DAMPING[0] * rates[0],
            -UPRIGHT * up[0] - DAMPING[1] * rates[1],
            yaw - DAMPING[2] * rates[2],
        )
        body.advance(force, torque, dt)
        if body.position[2] < 0.0:
            body.position = (body.position[0], body.position[1], 0.0)
            body.velocity = (body.velocity[0], body.velocity[1], max(body.velocity[2], 0.0))
        return body.state()
