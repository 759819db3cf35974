"""Flying on a wing: course by bank, height by the angle of climb, airspeed by the throttle.

A course is wanted that brings the body back to its line (or circle) over some seconds of flight, and the
bank is that of the lateral acceleration which turns the course there, with what the circle itself needs
known ahead. Height asks for a climb rate, and that for a climb angle and the pitch which with the lift
needed gives it; the throttle is what drag, climb and the airspeed's error need. Speed comes before height:
near the least airspeed the climb angle is bounded, so that without thrust a wing glides and does not stall.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.aerodynamics import DRAG_AT_ZERO, INDUCED_DRAG, LIFT_AT_ZERO, LIFT_SLOPE, MOST_LIFT
from mavstack.sim.motion.arrays import Array, Mask, bounded, dot, flat_length, wrapped
from mavstack.sim.motion.battery import GRAVITY
from mavstack.sim.motion.demands import Mode
from mavstack.sim.motion.multirotor import Wish

if TYPE_CHECKING:
    from mavstack.sim.motion.fleet import Fleet

#: Seconds of flight in which a line is joined, and how fast a course error is turned away (1/s).
JOINING = 3.0
COURSE_GAIN = 0.9
HEIGHT_GAIN = 0.4
STEEPEST = 0.45
#: A line whose direction is less horizontal than this has no course: the present one is kept.
FLATTEST = 0.02
#: The climb angle allowed SLACK m/s below the least airspeed, and how much more each m/s above it allows.
GLIDE_ANGLE = -0.14
ANGLE_PER_SPEED = 0.2
SLACK = 1.0
#: A turn never needs more than this share of the most lift; some bank is always allowed.
LIFT_USED, LEAST_BANK = 0.9, 0.2


def control(fleet: Fleet, step: float) -> Wish:
    """Say which attitude and throttle the demand needs."""
    ground_speed = np.maximum(flat_length(fleet.velocity_estimate), 0.1)
    course, ahead, climb, airspeed = _path(fleet, ground_speed)
    rolling = fleet.on_ground > 0.0
    track = np.where(
        ground_speed > 3.0,
        np.arctan2(fleet.velocity_estimate[1], fleet.velocity_estimate[0]),
        fleet.attitude_estimate[2],
    )
    lateral = ahead + COURSE_GAIN * ground_speed * wrapped(course - track)
    steepest = np.minimum(fleet.tilt, _steepest_bank(fleet))
    roll = np.where(rolling, 0.0, bounded(np.arctan(lateral * (1 / GRAVITY)), -steepest, steepest))
    pitch, throttle = _climbing(fleet, climb, airspeed, step)
    return _by_hand(fleet, Wish(roll, pitch, _turning(fleet, course, rolling), throttle))


def _steepest_bank(fleet: Fleet) -> Array:
    """Give the bank at which the turn's load leaves a margin to the stall."""
    needed = GRAVITY / (LIFT_USED * MOST_LIFT * fleet.wing * np.maximum(fleet.airspeed * fleet.airspeed, 1.0))
    return np.arccos(np.minimum(needed, np.cos(LEAST_BANK)))


def _path(fleet: Fleet, ground_speed: Array) -> tuple[Array, Array, Array, Array]:
    """Give course, lateral acceleration ahead, climb rate and airspeed wanted."""
    position, target, along = fleet.position_estimate, fleet.target, fleet.along
    _, most_climb, most_sink, speed = fleet.pace
    # a line
    off = position - fleet.start
    done = bounded(dot(off, along), 0.0, fleet.line_length)
    flat = np.maximum(flat_length(along), 1e-6)
    north, east = along[0] / flat, along[1] / flat
    aside = off[1] * north - off[0] * east
    joining = JOINING * ground_speed
    course = np.arctan2(along[1], along[0]) - np.arctan(aside / joining)
    ahead = np.zeros_like(course)
    slope = np.where(done < fleet.line_length, along[2] / flat * ground_speed, 0.0)
    climb = HEIGHT_GAIN * (position[2] - fleet.start[2] - along[2] * done) - slope
    upright = flat < FLATTEST
    course = np.where(upright, fleet.yaw_demand, course)
    climb = np.where(upright, HEIGHT_GAIN * (position[2] - target[2]), climb)
    around = fleet.mode == Mode.CIRCLE
    if around.any():
        circle_course, circle_ahead = _around(fleet, ground_speed, joining)
        course, ahead = np.where(around, circle_course, course), np.where(around, circle_ahead, ahead)
        climb = np.where(around, HEIGHT_GAIN * (position[2] - target[2]), climb)
    told = fleet.mode == Mode.VELOCITY
    if told.any():
        still = flat_length(target) < 0.5
        bearing = np.where(still, fleet.yaw_demand, np.arctan2(target[1], target[0]))
        course, climb = np.where(told, bearing, course), np.where(told, -target[2], climb)
        speed = np.where(told & ~still, flat_length(target), speed)
    airspeed = bounded(speed, fleet.airspeed_min, np.maximum(fleet.airspeed_max, fleet.airspeed_min))
    return course, ahead, bounded(climb, -most_sink, most_climb), airspeed


def _around(fleet: Fleet, ground_speed: Array, joining: Array) -> tuple[Array, Array]:
    """Give the course that joins and follows the circle, and the acceleration it bends with."""
    spoke = fleet.position_estimate[:2] - fleet.target[:2]
    distance = np.maximum(np.sqrt(spoke[0] * spoke[0] + spoke[1] * spoke[1]), 1.0)
    way = np.copysign(1.0, fleet.radius)
    radius = np.abs(fleet.radius)
    inward = np.arctan((distance - radius) / joining)
    course = np.arctan2(spoke[1], spoke[0]) + way * (0.5 * np.pi + inward)
    near = bounded(1.5 - np.abs(distance - radius) / joining, 0.0, 1.0)
    return course, way * near * ground_speed * ground_speed / np.maximum(distance, radius)


def _climbing(fleet: Fleet, climb: Array, airspeed: Array, step: float) -> tuple[Array, Array]:
    """Give pitch and throttle for a climb rate and an airspeed."""
    speed = np.maximum(fleet.airspeed, 3.0)
    wanted = bounded(climb / speed, -STEEPEST, STEEPEST)
    angle = np.minimum(wanted, GLIDE_ANGLE + ANGLE_PER_SPEED * (speed - fleet.airspeed_min + SLACK))
    angle = np.maximum(angle, ANGLE_PER_SPEED * (speed - fleet.airspeed_max - 2.0))
    flown = -fleet.velocity_estimate[2] / speed
    miss = angle - flown
    flying = (fleet.on_ground == 0.0) & (fleet.mode >= Mode.LINE) & (fleet.mode <= Mode.CIRCLE)
    fleet.climb_integral[:] = bounded(fleet.climb_integral + miss * (0.4 * step), -0.12, 0.12) * flying
    pressure = fleet.wing * speed * speed
    lift = np.minimum(GRAVITY / (pressure * np.maximum(np.cos(fleet.attitude_estimate[0]), 0.5)), MOST_LIFT)
    attack = (lift - LIFT_AT_ZERO) * (1 / LIFT_SLOPE)
    pitch = angle + attack + 0.5 * miss + fleet.climb_integral
    drag = pressure * (DRAG_AT_ZERO + INDUCED_DRAG * lift * lift)
    slow = airspeed - fleet.airspeed
    pull = drag + GRAVITY * np.maximum(wanted, angle) + bounded(0.7 * slow, -3.0, 3.0)
    fleet.speed_integral[:] = bounded(fleet.speed_integral + slow * (0.05 * step), -0.3, 0.3) * flying
    full = fleet.drive * bounded(1.0 - fleet.airspeed / fleet.drive_speed, 0.1, 1.0)
    return bounded(pitch, -0.5, 0.55), bounded(pull / full + fleet.speed_integral, 0.0, 1.0)


def _turning(fleet: Fleet, course: Array, rolling: Mask) -> Array:
    """Give the yaw rate of a coordinated turn; on the ground that of the steered wheel."""
    speed = np.maximum(fleet.airspeed, 6.0)
    banked = GRAVITY * np.tan(bounded(fleet.attitude_estimate[0], -1.2, 1.2)) / speed
    steered = bounded(wrapped(course - fleet.attitude_estimate[2]), -0.6, 0.6)
    moving = np.minimum(flat_length(fleet.velocity_estimate) * 0.2, 1.0)
    return bounded(np.where(rolling, steered * moving, banked), -1.5, 1.5)


def _by_hand(fleet: Fleet, wish: Wish) -> Wish:
    """Replace what the loops want where the demand says it directly."""
    mode, stick = fleet.mode, fleet.stick
    if ((mode >= Mode.LINE) & (mode <= Mode.CIRCLE)).all():
        return wish
    attitude, sticks = (mode == Mode.ATTITUDE), (mode == Mode.STICKS)
    off = (mode < Mode.LINE) | (mode == Mode.ROLL_OUT)
    reach = fleet.rate_limit / fleet.attitude_gain
    roll, pitch = wish.roll, wish.pitch
    roll = np.where(attitude, bounded(stick[0], -1.2, 1.2), np.where(off, 0.0, roll))
    pitch = np.where(attitude, bounded(stick[1], -1.2, 1.2), np.where(off, 0.0, pitch))
    roll = np.where(sticks, fleet.attitude_estimate[0] + stick[0] * reach[0], roll)
    pitch = np.where(sticks, fleet.attitude_estimate[1] + stick[1] * reach[1], pitch)
    turn = np.where(sticks, wish.turn + stick[2] * fleet.rate_limit[2], wish.turn)
    throttle = np.where(mode > Mode.CIRCLE, stick[3], wish.thrust)
    return Wish(roll, pitch, turn, np.where(off, 0.0, throttle))
