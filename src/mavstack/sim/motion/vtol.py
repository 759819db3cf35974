"""Quadplanes: blending between hover and forward flight.

`transition` goes from 0 (hover) to 1 (wing-borne) with the airspeed. In the forward transition the pusher is
at full power, the wings are level and the lifting motors carry the rest of the weight; they also help a
wing-borne body that is too slow. In the back transition the pusher stops and the hover loops take over, with
little tilt while the wing still lifts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, clip, wrap_angle
from mavstack.sim.motion.battery import GRAVITY
from mavstack.sim.motion.demands import Mode
from mavstack.sim.motion.multirotor import AttitudeCommand

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: Airspeed in m/s from which the wing carries a part of the weight; times the second factor, the minimum
#: airspeed is the airspeed at which the wing carries all of it.
MIN_LIFT_AIRSPEED = 5.0
AIRSPEED_MARGIN = 1.05
#: Below this share of the minimum airspeed the lifting motors help in forward flight.
ASSIST_SHARE = 0.85
TRANSITION_TIME = 1.5
LEVEL_PITCH = 0.05
#: Additional pitch (rad) that is allowed while braking, for each m/s2 of lift that the wing lacks.
PITCH_PER_LIFT = 0.05
#: The pusher starts if the heading error (rad) is below the first value; once the transition has reached the
#: second value, the pusher runs with any heading error.
MAX_HEADING_ERROR, COMMITTED_SHARE = 0.4, 0.3


def update_transition(state: StateArray, step: float) -> None:
    """Advance the transition as the airspeed allows."""
    full = state.airspeed_min * AIRSPEED_MARGIN
    carried = clip((state.airspeed - MIN_LIFT_AIRSPEED) / (full - MIN_LIFT_AIRSPEED), 0.0, 1.0)
    forward = state.forward_requested > 0.0
    wing_borne = forward & (state.transition >= 1.0) & (state.airspeed > ASSIST_SHARE * state.airspeed_min)
    goal = np.where(wing_borne, 1.0, carried)
    goal = np.where(forward, goal, np.minimum(carried, state.transition) * 0.98)
    maximum = step / TRANSITION_TIME
    moved = state.transition + clip(goal - state.transition, -maximum, maximum)
    state.transition[:] = np.where(~forward & (moved < 0.02), 0.0, moved)


def blend(state: StateArray, hover: AttitudeCommand, wing: AttitudeCommand) -> tuple[AttitudeCommand, Array]:
    """Blend both controllers; return the attitude command with the lift, and the pusher's share."""
    share = state.transition
    guided = (state.mode >= Mode.LINE) & (state.mode <= Mode.CIRCLE)
    forward = (state.forward_requested > 0.0) & guided
    flown = (state.forward_requested > 0.0) & (share >= 1.0)
    roll = np.where(forward, wing.roll * share, hover.roll)
    spare = np.maximum(GRAVITY - state.wing_up, -0.3 * GRAVITY)
    raised = np.minimum(hover.pitch, LEVEL_PITCH + PITCH_PER_LIFT * spare)
    pitch = np.where(forward, wing.pitch * share + LEVEL_PITCH * (1.0 - share), raised)
    turn = np.where(forward, wing.turn * share + hover.turn * (1.0 - share), hover.turn)
    carried = np.where(guided, np.maximum(hover.thrust - state.wing_up, 0.0), hover.thrust)
    lift = np.where(flown, 0.0, carried)
    aligned = np.abs(wrap_angle(state.yaw_demand - state.attitude_estimate[2])) < MAX_HEADING_ERROR
    ready = forward & (share < 1.0) & (state.on_ground == 0.0) & (aligned | (share > COMMITTED_SHARE))
    push = np.where(ready, 1.0, 0.0)
    push = np.where(flown, wing.thrust, push)
    attitude = AttitudeCommand(
        np.where(flown, wing.roll, roll),
        np.where(flown, wing.pitch, pitch),
        np.where(flown, wing.turn, turn),
        lift,
    )
    return attitude, push


def share_authority(state: StateArray, authority: Array, push: Array) -> None:
    """Combine the authority of control surfaces (given) and lifting motors."""
    motors = np.minimum(state.lift_thrust * 0.2, 1.0) * state.authority
    state.authority[:] = np.maximum(authority, motors)
    state.rate_disturbance += push * (1.0 - motors)
