"""Guidance from a demand to a velocity, for all bodies that can stop (all but wings).

Along a line the speed towards its end is that of a constant deceleration (`approach_speed`), and the lateral
error is closed the same way, so that a body joins the line, follows it and stops at its end. On a circle the
velocity is the tangential one plus a correction of the radius error. The velocity command follows this
setpoint no faster than the allowed acceleration; the change is fed forward to the velocity loop.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, approach_speed, clip, dot, horizontal_length, limit_length
from mavstack.sim.motion.demands import Mode

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: Share of the maximum acceleration that is planned for braking and circling; the rest corrects errors.
PLANNED_SHARE = 0.6
#: Distances are limited to this many metres when the speed is planned.
MAX_DISTANCE = 1e5


def update_velocity_command(state: StateArray, step: float) -> None:
    """Compute each body's velocity setpoint, and move its velocity command towards it."""
    free = (state.mode < Mode.LINE) | (state.mode > Mode.CIRCLE) | (state.transition >= 1.0)
    setpoint = state.velocity_setpoint
    for mode, velocity_of in (
        (Mode.LINE, _line_velocity),
        (Mode.VELOCITY, _demanded_velocity),
        (Mode.CIRCLE, _circle_velocity),
    ):
        selected = state.mode == mode
        if selected.any():
            np.copyto(setpoint, velocity_of(state), where=selected)
    np.copyto(setpoint, state.velocity_estimate, where=free)
    change = setpoint - state.velocity_command
    maximum = state.acceleration_limit * step
    change[:2] = limit_length(change[:2], maximum)
    change[2] = clip(change[2], -maximum, maximum)
    state.velocity_command += change
    np.divide(change, step, out=state.acceleration_feedforward)
    np.copyto(state.velocity_command, state.velocity_estimate, where=free)
    np.copyto(state.acceleration_feedforward, 0.0, where=free)
    np.copyto(state.integral, 0.0, where=free)


def _line_velocity(state: StateArray) -> Array:
    """Return the velocity that follows the line to its end."""
    position, along = state.position_estimate, state.line_direction
    done = clip(dot(position - state.start, along), 0.0, state.line_length)
    off = state.start + along * done - position
    speed, climb, sink, _ = state.speeds
    deceleration = state.acceleration_limit * PLANNED_SHARE
    flat = horizontal_length(along)
    vertical_pace = np.where(along[2] < 0.0, climb, sink)
    pace = np.minimum(speed / np.maximum(flat, 1e-6), vertical_pace / np.maximum(np.abs(along[2]), 1e-6))
    gain = state.position_gain
    setpoint: Array = along * np.minimum(approach_speed(state.line_length - done, gain, deceleration), pace)
    setpoint += _correction(off, state, deceleration)
    return _limit_speed(setpoint, state)


def _correction(off: Array, state: StateArray, deceleration: Array) -> Array:
    """Return the velocity that closes the position error `off`."""
    gain = state.position_gain
    speed, climb, sink, _ = state.speeds
    distance = np.minimum(horizontal_length(off), MAX_DISTANCE)
    closing = np.empty_like(off)
    closing[:2] = off[:2] * (
        np.minimum(approach_speed(distance, gain, deceleration), speed)
        / np.maximum(horizontal_length(off), 1e-9)
    )
    vertical = np.minimum(np.abs(off[2]), MAX_DISTANCE)
    closing[2] = clip(np.copysign(approach_speed(vertical, gain, deceleration), off[2]), -climb, sink)
    return closing


def _demanded_velocity(state: StateArray) -> Array:
    """Return the demanded velocity."""
    return state.target


def _circle_velocity(state: StateArray) -> Array:
    """Return the velocity that follows the circle around the target."""
    from_centre = state.position_estimate - state.target
    distance = horizontal_length(from_centre)
    outward = from_centre[:2] / np.maximum(distance, 1e-6)
    deceleration = state.acceleration_limit * PLANNED_SHARE
    radius = np.abs(state.radius)
    error = radius - distance
    closing = np.minimum(
        approach_speed(np.minimum(np.abs(error), MAX_DISTANCE), state.position_gain, deceleration),
        state.speeds[0],
    )
    inward = np.copysign(closing, error)
    # The speed along the circle is limited by the centripetal acceleration, and is lower far from the circle.
    tangential = np.minimum(state.speeds[0], np.sqrt(deceleration * radius)) / (1.0 + np.abs(error) * 0.2)
    tangential = np.copysign(tangential, state.radius)
    setpoint = _correction(-from_centre, state, deceleration)
    setpoint[0] = outward[0] * inward - outward[1] * tangential
    setpoint[1] = outward[1] * inward + outward[0] * tangential
    return _limit_speed(setpoint, state)


def _limit_speed(setpoint: Array, state: StateArray) -> Array:
    """Limit the sum of tracking and correction to the demanded speeds."""
    speed, climb, sink, _ = state.speeds
    setpoint[:2] = limit_length(setpoint[:2], speed)
    setpoint[2] = clip(setpoint[2], -climb, sink)
    return setpoint
