"""Copters, and VTOLs in hover: thrust along the body's vertical axis, leaned to where it is wanted.

The velocity loop (proportional and integral, with the command's change known ahead) wants an acceleration;
with gravity it is the thrust vector wanted, whose direction gives roll and pitch and whose length the
thrust. The vertical comes first: horizontally no more is asked than the tilt allowed gives.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mavstack.sim.motion.arrays import Array, bounded, shortened
from mavstack.sim.motion.attitude import wanted_turn
from mavstack.sim.motion.battery import GRAVITY, strength
from mavstack.sim.motion.demands import Mode

if TYPE_CHECKING:
    from mavstack.sim.motion.fleet import Fleet

#: Share of the full thrust the velocity loop leaves unused, for the attitude.
RESERVE = 0.95
#: The velocity loop never falls faster than this leaves (m/s2 upwards wanted).
LEAST_UPWARD = 2.0
#: The most the integral part holds against, in m/s2.
MOST_INTEGRAL = 4.0


class Wish(NamedTuple):
    """The attitude a loop wants, the rate it turns at, and its thrust (lift in m/s2, or a share of drive)."""

    roll: Array
    pitch: Array
    turn: Array
    thrust: Array


def acceleration_wanted(fleet: Fleet, step: float) -> Array:
    """Run the velocity loop."""
    error = fleet.velocity_command - fleet.velocity_estimate
    grounded = fleet.on_ground > 0.0
    fleet.integral += error * (fleet.integral_gain * step)
    np.minimum(
        np.maximum(fleet.integral, -MOST_INTEGRAL, out=fleet.integral), MOST_INTEGRAL, out=fleet.integral
    )
    np.copyto(fleet.integral, 0.0, where=grounded)
    error[:2] *= fleet.velocity_gain
    error[2] *= fleet.heave_gain
    error += fleet.integral
    error += fleet.acceleration_ahead
    return error


def control(fleet: Fleet, step: float) -> Wish:
    """Say which attitude and lift the demand needs."""
    wanted = acceleration_wanted(fleet, step)
    upward = np.maximum(GRAVITY - wanted[2], LEAST_UPWARD)
    tilt = fleet.tilt * (1.0 - 0.8 * fleet.transition)
    wanted[:2] = shortened(wanted[:2], np.minimum(upward, GRAVITY) * np.tan(tilt))
    yaw = fleet.attitude_estimate[2]
    cosine, sine = np.cos(yaw), np.sin(yaw)
    ahead = wanted[0] * cosine + wanted[1] * sine
    aside = wanted[1] * cosine - wanted[0] * sine
    slant = np.sqrt(upward * upward + ahead * ahead)
    roll, pitch = np.arctan2(aside, slant), -np.arctan2(ahead, upward)
    lift = np.minimum(np.sqrt(slant * slant + aside * aside), fleet.lift * RESERVE)
    return _by_hand(fleet, Wish(roll, pitch, wanted_turn(fleet), lift))


def _by_hand(fleet: Fleet, wish: Wish) -> Wish:
    """Replace what the loops want where the demand says it directly."""
    direct = (fleet.mode < Mode.LINE) | (fleet.mode > Mode.CIRCLE)
    if not direct.any():
        return wish
    spun = fleet.mode > Mode.CIRCLE
    share = np.where(fleet.mode == Mode.STICKS, fleet.tilt, 1.0) * spun
    thrust = fleet.stick[3] * fleet.lift * (spun & (fleet.mode < Mode.ROLL_OUT))
    return Wish(
        np.where(direct, fleet.stick[0] * share, wish.roll),
        np.where(direct, fleet.stick[1] * share, wish.pitch),
        wish.turn,
        np.where(direct, thrust, wish.thrust),
    )


def wear(fleet: Fleet) -> None:
    """Let dead motors take authority away, spin the body and lean it."""
    whole = fleet.lift_left
    fleet.authority[:] = 0.3 + 0.7 * whole
    fleet.push[:] = fleet.lean
    flying = (fleet.lift_thrust > 1.0) & (fleet.on_ground == 0.0)
    fleet.push *= flying
    fleet.push[2] += fleet.spin * flying


def lift(fleet: Fleet, wanted: Array) -> None:
    """Spin the lifting motors towards the lift wanted, and let them pull."""
    most = fleet.lift * fleet.lift_left * strength(fleet)
    aim = np.minimum(bounded(wanted, 0.0, fleet.lift) * strength(fleet), most)
    fleet.lift_thrust += (aim - fleet.lift_thrust) * fleet.lift_response
    fleet.force -= fleet.below * fleet.lift_thrust
