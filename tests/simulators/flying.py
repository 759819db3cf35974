"""Pilots for bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mavstack.rotation import to_euler

if TYPE_CHECKING:
    from mavstack.simulators.physics import Physics
    from mavstack.simulators.state import State


def hold_attitude(state: State, lift: float, roll: float = 0.0, pitch: float = 0.0) -> list[float]:
    """Return the motors of a quadrotor that hold an attitude in radians at a mean command."""
    now = to_euler(state.attitude)
    p, q, r = state.rates
    about_x = 0.4 * (roll - now[0]) - 0.08 * p
    about_y = 0.4 * (pitch - now[1]) - 0.08 * q
    about_z = -0.1 * r
    return [
        lift - about_x + about_y + about_z,
        lift + about_x - about_y + about_z,
        lift + about_x + about_y - about_z,
        lift - about_x - about_y - about_z,
    ]


def climb_out(plane: Physics, state: State, seconds: float, pitch: float = 10.0) -> State:
    """Fly a plane at full throttle with level wings and a pitch in degrees."""
    for _ in range(round(seconds / 0.004)):
        roll, nose, _ = to_euler(state.attitude)
        p, q, _ = state.rates
        elevator = max(-1.0, min(1.0, 2.0 * (math.radians(pitch) - nose) - 0.3 * q))
        aileron = max(-1.0, min(1.0, -1.5 * roll - 0.3 * p))
        state = plane.step((aileron, elevator, 1.0, 0.0), 0.004)
    return state
