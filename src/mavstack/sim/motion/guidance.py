"""From a demand to a velocity, for all that can stop: VTOL in hover, copter, sub, rover, boat.

Along a line the speed towards its end is that of a constant deceleration (`approach_speed`), and its error
sideways is closed the same way, so that a body joins the line, follows it and stops at its end. On a circle
it is the tangent's, plus what closes the error of the radius. What is wanted is then approached no faster
than the acceleration allowed; this change is known ahead to the velocity loop.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import (
    Array,
    approach_speed,
    bounded,
    dot,
    flat_length,
    shortened,
)
from mavstack.sim.motion.demands import Mode

if TYPE_CHECKING:
    from mavstack.sim.motion.fleet import Fleet

#: Share of the acceleration allowed that braking and circling are planned with; the rest is for errors.
PLANNED = 0.6
#: Beyond this distance there is nothing faster to plan.
FAR = 1e5


def guide(fleet: Fleet, step: float) -> None:
    """Find the velocity each body wants, and move its command towards it."""
    free = (fleet.mode < Mode.LINE) | (fleet.mode > Mode.CIRCLE) | (fleet.transition >= 1.0)
    wanted = fleet.velocity_wanted
    for mode, find in ((Mode.LINE, _along_line), (Mode.VELOCITY, _as_told), (Mode.CIRCLE, _around)):
        asked = fleet.mode == mode
        if asked.any():
            np.copyto(wanted, find(fleet), where=asked)
    np.copyto(wanted, fleet.velocity_estimate, where=free)
    change = wanted - fleet.velocity_command
    most = fleet.acceleration_limit * step
    change[:2] = shortened(change[:2], most)
    change[2] = bounded(change[2], -most, most)
    fleet.velocity_command += change
    np.divide(change, step, out=fleet.acceleration_ahead)
    np.copyto(fleet.velocity_command, fleet.velocity_estimate, where=free)
    np.copyto(fleet.acceleration_ahead, 0.0, where=free)
    np.copyto(fleet.integral, 0.0, where=free)


def _along_line(fleet: Fleet) -> Array:
    """Follow the line to its end."""
    position, along = fleet.position_estimate, fleet.along
    done = bounded(dot(position - fleet.start, along), 0.0, fleet.line_length)
    off = fleet.start + along * done - position
    speed, climb, sink, _ = fleet.pace
    deceleration = fleet.acceleration_limit * PLANNED
    flat = flat_length(along)
    vertical_pace = np.where(along[2] < 0.0, climb, sink)
    pace = np.minimum(speed / np.maximum(flat, 1e-6), vertical_pace / np.maximum(np.abs(along[2]), 1e-6))
    gain = fleet.position_gain
    wanted: Array = along * np.minimum(approach_speed(fleet.line_length - done, gain, deceleration), pace)
    wanted += _closing(off, fleet, deceleration)
    return _within_pace(wanted, fleet)


def _closing(off: Array, fleet: Fleet, deceleration: Array) -> Array:
    """Give the velocity that takes away the error `off`."""
    gain = fleet.position_gain
    speed, climb, sink, _ = fleet.pace
    distance = np.minimum(flat_length(off), FAR)
    closing = np.empty_like(off)
    closing[:2] = off[:2] * (
        np.minimum(approach_speed(distance, gain, deceleration), speed) / np.maximum(flat_length(off), 1e-9)
    )
    vertical = np.minimum(np.abs(off[2]), FAR)
    closing[2] = bounded(np.copysign(approach_speed(vertical, gain, deceleration), off[2]), -climb, sink)
    return closing


def _as_told(fleet: Fleet) -> Array:
    return fleet.target


def _around(fleet: Fleet) -> Array:
    """Follow the circle around the target."""
    spoke = fleet.position_estimate - fleet.target
    distance = flat_length(spoke)
    outward = spoke[:2] / np.maximum(distance, 1e-6)
    deceleration = fleet.acceleration_limit * PLANNED
    radius = np.abs(fleet.radius)
    error = radius - distance
    closing = np.minimum(
        approach_speed(np.minimum(np.abs(error), FAR), fleet.position_gain, deceleration), fleet.pace[0]
    )
    inward = np.copysign(closing, error)
    # sideways only as fast as the circle can be held, and less while it is still far away
    tangential = np.minimum(fleet.pace[0], np.sqrt(deceleration * radius)) / (1.0 + np.abs(error) * 0.2)
    tangential = np.copysign(tangential, fleet.radius)
    wanted = _closing(-spoke, fleet, deceleration)
    wanted[0] = outward[0] * inward - outward[1] * tangential
    wanted[1] = outward[1] * inward + outward[0] * tangential
    return _within_pace(wanted, fleet)


def _within_pace(wanted: Array, fleet: Fleet) -> Array:
    """Go no faster than told, whatever has to be done at once: along the way and towards it."""
    speed, climb, sink, _ = fleet.pace
    wanted[:2] = shortened(wanted[:2], speed)
    wanted[2] = bounded(wanted[2], -climb, sink)
    return wanted
