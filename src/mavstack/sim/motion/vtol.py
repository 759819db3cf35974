"""Quadplanes: between hover and wing.

`transition` goes from 0 (hover) to 1 (wing-borne) with the airspeed. On the way forward the pusher is at
full power, the wings are level and the lifting motors carry what the wing does not yet; they come back on
whenever a wing-borne body is too slow. On the way back the pusher stops and the hover loops take over, with
little tilt while the wing still lifts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, bounded, wrapped
from mavstack.sim.motion.battery import GRAVITY
from mavstack.sim.motion.demands import Mode
from mavstack.sim.motion.multirotor import Wish

if TYPE_CHECKING:
    from mavstack.sim.motion.fleet import Fleet

#: Airspeed from which the wing begins to count, and the margin over the least airspeed at which it is all.
FIRST_LIFT = 5.0
MARGIN = 1.05
#: Below this share of the least airspeed a wing-borne body is helped by its lifting motors.
TOO_SLOW = 0.85
SECONDS = 1.5
LEVEL = 0.05
#: Braking, the nose rises only this much (rad) for each m/s2 the wing lifts less than the weight.
RAISED = 0.05
#: The pusher waits until the nose is this near its heading, unless already this far on the wing.
ALIGNED, TURNED = 0.4, 0.3


def shift(fleet: Fleet, step: float) -> None:
    """Move the transition on, as airspeed allows."""
    full = fleet.airspeed_min * MARGIN
    carried = bounded((fleet.airspeed - FIRST_LIFT) / (full - FIRST_LIFT), 0.0, 1.0)
    forward = fleet.go_forward > 0.0
    borne = forward & (fleet.transition >= 1.0) & (fleet.airspeed > TOO_SLOW * fleet.airspeed_min)
    goal = np.where(borne, 1.0, carried)
    goal = np.where(forward, goal, np.minimum(carried, fleet.transition) * 0.98)
    most = step / SECONDS
    moved = fleet.transition + bounded(goal - fleet.transition, -most, most)
    fleet.transition[:] = np.where(~forward & (moved < 0.02), 0.0, moved)


def blend(fleet: Fleet, hover: Wish, wing: Wish) -> tuple[Wish, Array]:
    """Mix what both loops want; give the attitude with the lift, and the pusher's share."""
    share = fleet.transition
    guided = (fleet.mode >= Mode.LINE) & (fleet.mode <= Mode.CIRCLE)
    forward = (fleet.go_forward > 0.0) & guided
    flown = (fleet.go_forward > 0.0) & (share >= 1.0)
    roll = np.where(forward, wing.roll * share, hover.roll)
    spare = np.maximum(GRAVITY - fleet.wing_up, -0.3 * GRAVITY)
    raised = np.minimum(hover.pitch, LEVEL + RAISED * spare)
    pitch = np.where(forward, wing.pitch * share + LEVEL * (1.0 - share), raised)
    turn = np.where(forward, wing.turn * share + hover.turn * (1.0 - share), hover.turn)
    carried = np.where(guided, np.maximum(hover.thrust - fleet.wing_up, 0.0), hover.thrust)
    lift = np.where(flown, 0.0, carried)
    aligned = np.abs(wrapped(fleet.yaw_demand - fleet.attitude_estimate[2])) < ALIGNED
    ready = forward & (share < 1.0) & (fleet.on_ground == 0.0) & (aligned | (share > TURNED))
    push = np.where(ready, 1.0, 0.0)
    push = np.where(flown, wing.thrust, push)
    attitude = Wish(
        np.where(flown, wing.roll, roll),
        np.where(flown, wing.pitch, pitch),
        np.where(flown, wing.turn, turn),
        lift,
    )
    return attitude, push


def share_authority(fleet: Fleet, authority: Array, push: Array) -> None:
    """Let surfaces, of which authority and push are given, and lifting motors turn the body together."""
    motors = np.minimum(fleet.lift_thrust * 0.2, 1.0) * fleet.authority
    fleet.authority[:] = np.maximum(authority, motors)
    fleet.push += push * (1.0 - motors)
