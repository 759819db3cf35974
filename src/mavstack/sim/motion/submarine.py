"""Submarines: thrusters along every axis, water that drags, a little buoyancy.

The velocity loop of the multirotor wants an acceleration; thrusters give it in any direction, after a lag,
as far as they are strong. Nothing needs to lean. At the surface there is no buoyancy left to rise with.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, bounded, length, shortened
from mavstack.sim.motion.attitude import wanted_turn
from mavstack.sim.motion.battery import GRAVITY, strength
from mavstack.sim.motion.demands import Mode
from mavstack.sim.motion.multirotor import Wish, acceleration_wanted

if TYPE_CHECKING:
    from mavstack.sim.motion.fleet import Fleet

#: Drag of the hull per mass: in proportion to speed (1/s) and to its square (1/m).
DRAG, DRAG_SQUARED = 0.15, 0.42
#: Upward, in m/s2.
BUOYANCY = 0.06
#: Sticks and attitude demands lean this far at most.
MOST_LEAN = 0.8


def control(fleet: Fleet, step: float) -> tuple[Wish, Array]:
    """Give the attitude wanted, and the acceleration wanted of the thrusters."""
    wanted = acceleration_wanted(fleet, step)
    wanted[:2] = shortened(wanted[:2], fleet.lift)
    wanted[2] += BUOYANCY
    mode, stick = fleet.mode, fleet.stick
    guided = (mode >= Mode.LINE) & (mode <= Mode.CIRCLE)
    leaned = mode == Mode.ATTITUDE
    roll = np.where(leaned, bounded(stick[0], -MOST_LEAN, MOST_LEAN), 0.0)
    pitch = np.where(leaned, bounded(stick[1], -MOST_LEAN, MOST_LEAN), 0.0)
    if not guided.all():
        wanted = np.where(guided, wanted, _by_hand(fleet))
    return Wish(roll, pitch, wanted_turn(fleet), wanted[2]), wanted


def _by_hand(fleet: Fleet) -> Array:
    """Give the acceleration that sticks or a vertical thrust (0.5: none) ask for."""
    mode, stick = fleet.mode, fleet.stick
    sticks = mode == Mode.STICKS
    held = (mode == Mode.ATTITUDE) | (mode == Mode.RATES)
    ahead, aside = stick[1] * sticks, stick[0] * sticks
    up = np.where(sticks, stick[3], (2.0 * stick[3] - 1.0) * held)
    pull: Array = (fleet.forward * ahead + fleet.right * aside - fleet.below * up) * fleet.lift
    return pull


def move(fleet: Fleet, wanted: Array) -> None:
    """Let thrusters, water and buoyancy act."""
    most = fleet.lift
    aim = np.minimum(np.maximum(wanted, -most), most) * (strength(fleet) * fleet.lift_left)
    fleet.thrust += (aim - fleet.thrust) * fleet.lift_response
    fleet.lift_thrust[:] = length(fleet.thrust)
    drag = DRAG + DRAG_SQUARED * length(fleet.velocity)
    fleet.force += fleet.thrust - fleet.velocity * drag
    sunk = np.minimum(np.maximum(fleet.position[2] * 5.0, 0.0), 1.0)
    fleet.force[2] -= GRAVITY + BUOYANCY * sunk
