"""A rigid body on a flat ground: the equations of motion that all own bodies share.

Position and velocity are in north, east, down (NED) of home, forces and torques in body axes. Each step uses
the semi-implicit method of Euler: velocities first, then positions by the new velocities, which keeps energy
bounded at the steps of simulators (1 to 5 ms). On the ground the body stands level on its legs, and friction
holds it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mavstack.rotation import LEVEL, from_euler, rotate, rotate_back, to_euler, turned
from mavstack.simulators.state import GRAVITY, State

if TYPE_CHECKING:
    from mavstack.rotation import Quaternion, Vector

_STILL: Vector = (0.0, 0.0, 0.0)


class RigidBody:
    """Motion of one body.

    Args:
        mass: Kilograms.
        inertia: Moments about the body axes in kg m2; products of inertia are zero.
    """

    def __init__(self, mass: float, inertia: Vector) -> None:
        self.mass = mass
        self.inertia = inertia
        self.place(0.0)

    def place(self, heading: float) -> None:
        """Put it at home, at rest and level, with a heading in degrees."""
        self.position: Vector = _STILL
        self.velocity: Vector = _STILL
        self.rates: Vector = _STILL
        self.attitude: Quaternion = from_euler(0.0, 0.0, math.radians(heading)) if heading else LEVEL
        self.specific_force: Vector = (0.0, 0.0, -GRAVITY)

    @property
    def is_on_ground(self) -> bool:
        """True if it touches the ground."""
        return self.position[2] >= 0.0

    def body_velocity(self, wind: Vector = _STILL) -> Vector:
        """Return the velocity through air that moves with a wind (NED, m/s), in body axes."""
        velocity = self.velocity
        through = (velocity[0] - wind[0], velocity[1] - wind[1], velocity[2] - wind[2])
        return rotate_back(self.attitude, through)

    def advance(self, force: Vector, torque: Vector, dt: float) -> None:
        """Move by a force (newtons) and a torque (newton metres) in body axes, and by gravity."""
        self._turn(torque, dt)
        a, b, c = force[0] / self.mass, force[1] / self.mass, force[2] / self.mass
        north, east, down = rotate(self.attitude, (a, b, c))
        self._move((north, east, down + GRAVITY), dt)
        self.specific_force = (a, b, c)

    def rest(self, dt: float, brake: float = 20.0) -> bool:
        """Let the ground carry it: legs stop its fall, its tilt and, with `brake` m/s2, its sliding.

        Returns:
            True if it is on the ground and does not leave it.
        """
        if self.position[2] < 0.0 or self.velocity[2] < -1e-3:
            return False
        north, east, _ = self.velocity
        speed = math.hypot(north, east)
        kept = max(1.0 - brake * dt / speed, 0.0) if speed > 0.0 else 0.0
        after = (north * kept, east * kept, 0.0)
        push = ((after[0] - north) / dt, (after[1] - east) / dt, -GRAVITY)
        self.velocity = after
        self.position = (self.position[0], self.position[1], 0.0)
        yaw = to_euler(self.attitude)[2]
        self.attitude = from_euler(0.0, 0.0, yaw)
        self.rates = (0.0, 0.0, self.rates[2] * max(1.0 - brake * dt, 0.0))
        self.specific_force = rotate_back(self.attitude, push)
        return True

    def state(self, airspeed: float | None = None, battery: tuple[float, float] | None = None) -> State:
        """Return the state, with what the body alone knows."""
        return State(
            self.position, self.velocity, self.attitude, self.rates, self.specific_force, airspeed, battery
        )

    def _turn(self, torque: Vector, dt: float) -> None:
        (p, q, r), (ix, iy, iz) = self.rates, self.inertia
        self.rates = (
            p + dt * (torque[0] - (iz - iy) * q * r) / ix,
            q + dt * (torque[1] - (ix - iz) * p * r) / iy,
            r + dt * (torque[2] - (iy - ix) * p * q) / iz,
        )
        self.attitude = turned(self.attitude, self.rates, dt)

    def _move(self, acceleration: Vector, dt: float) -> None:
        north, east, down = self.velocity
        north += acceleration[0] * dt
        east += acceleration[1] * dt
        down += acceleration[2] * dt
        self.velocity = (north, east, down)
        x, y, z = self.position
        self.position = (x + north * dt, y + east * dt, z + down * dt)
