"""Forward flight: course by bank, height by climb angle, airspeed by throttle.

The commanded course returns the body to its line (or circle) over some seconds of flight; the bank follows
from the lateral acceleration that turns the course, with the acceleration of the circle fed forward. A height
error yields a climb rate, the climb rate a climb angle, and that the pitch which produces it with the lift
needed; the throttle covers drag, climb and airspeed error. Speed has priority over height: near the minimum
airspeed the climb angle is bounded, so that without thrust a wing glides and does not stall.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.aerodynamics import DRAG_AT_ZERO, INDUCED_DRAG, LIFT_AT_ZERO, LIFT_SLOPE, MAX_LIFT
from mavstack.sim.motion.arrays import Array, Mask, clip, dot, horizontal_length, wrap_angle
from mavstack.sim.motion.battery import GRAVITY
from mavstack.sim.motion.demands import Mode
from mavstack.sim.motion.multirotor import AttitudeCommand

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: Seconds of flight in which a wing joins a line, and gain of the course error (1/s).
JOIN_TIME = 3.0
COURSE_GAIN = 0.9
HEIGHT_GAIN = 0.4
MAX_CLIMB_ANGLE = 0.45
#: If the horizontal part of a line's unit vector is below this, the line has no course and the wing keeps its
#: heading.
MIN_HORIZONTAL = 0.02
#: Maximum climb angle (rad) at an airspeed of the minimum less AIRSPEED_MARGIN, and its increase for each m/s
#: of airspeed above that.
GLIDE_ANGLE = -0.14
ANGLE_PER_SPEED = 0.2
AIRSPEED_MARGIN = 1.0
#: Share of the maximum lift that a turn may use; a bank up to MIN_BANK (rad) is always allowed.
MAX_LIFT_SHARE, MIN_BANK = 0.9, 0.2


def control(state: StateArray, step: float) -> AttitudeCommand:
    """Return the attitude and throttle that the demand needs."""
    ground_speed = np.maximum(horizontal_length(state.velocity_estimate), 0.1)
    course, ahead, climb, airspeed = _path_targets(state, ground_speed)
    rolling = state.on_ground > 0.0
    track = np.where(
        ground_speed > 3.0,
        np.arctan2(state.velocity_estimate[1], state.velocity_estimate[0]),
        state.attitude_estimate[2],
    )
    lateral = ahead + COURSE_GAIN * ground_speed * wrap_angle(course - track)
    steepest = np.minimum(state.tilt, _max_bank(state))
    roll = np.where(rolling, 0.0, clip(np.arctan(lateral * (1 / GRAVITY)), -steepest, steepest))
    pitch, throttle = _climb_control(state, climb, airspeed, step)
    return _apply_direct_demands(
        state, AttitudeCommand(roll, pitch, _yaw_rate(state, course, rolling), throttle)
    )


def _max_bank(state: StateArray) -> Array:
    """Return the bank at which the load of the turn leaves a margin to the stall."""
    required_whole = GRAVITY / (
        MAX_LIFT_SHARE * MAX_LIFT * state.wing * np.maximum(state.airspeed * state.airspeed, 1.0)
    )
    return np.arccos(np.minimum(required_whole, np.cos(MIN_BANK)))


def _path_targets(state: StateArray, ground_speed: Array) -> tuple[Array, Array, Array, Array]:
    """Return course, lateral acceleration feed-forward, climb rate and airspeed."""
    position, target, along = state.position_estimate, state.target, state.line_direction
    _, max_climb, max_sink, speed = state.speeds
    # the values for a line
    off = position - state.start
    done = clip(dot(off, along), 0.0, state.line_length)
    flat = np.maximum(horizontal_length(along), 1e-6)
    north, east = along[0] / flat, along[1] / flat
    aside = off[1] * north - off[0] * east
    joining = JOIN_TIME * ground_speed
    course = np.arctan2(along[1], along[0]) - np.arctan(aside / joining)
    ahead = np.zeros_like(course)
    slope = np.where(done < state.line_length, along[2] / flat * ground_speed, 0.0)
    climb = HEIGHT_GAIN * (position[2] - state.start[2] - along[2] * done) - slope
    upright = flat < MIN_HORIZONTAL
    course = np.where(upright, state.yaw_demand, course)
    climb = np.where(upright, HEIGHT_GAIN * (position[2] - target[2]), climb)
    around = state.mode == Mode.CIRCLE
    if around.any():
        circle_course, circle_ahead = _circle_course(state, ground_speed, joining)
        course, ahead = np.where(around, circle_course, course), np.where(around, circle_ahead, ahead)
        climb = np.where(around, HEIGHT_GAIN * (position[2] - target[2]), climb)
    demanded = state.mode == Mode.VELOCITY
    if demanded.any():
        still = horizontal_length(target) < 0.5
        bearing = np.where(still, state.yaw_demand, np.arctan2(target[1], target[0]))
        course, climb = np.where(demanded, bearing, course), np.where(demanded, -target[2], climb)
        speed = np.where(demanded & ~still, horizontal_length(target), speed)
    airspeed = clip(speed, state.airspeed_min, np.maximum(state.airspeed_max, state.airspeed_min))
    return course, ahead, clip(climb, -max_sink, max_climb), airspeed


def _circle_course(state: StateArray, ground_speed: Array, joining: Array) -> tuple[Array, Array]:
    """Return the course that joins and follows the circle, and the lateral acceleration on it."""
    from_centre = state.position_estimate[:2] - state.target[:2]
    distance = np.maximum(np.sqrt(from_centre[0] * from_centre[0] + from_centre[1] * from_centre[1]), 1.0)
    direction = np.copysign(1.0, state.radius)
    radius = np.abs(state.radius)
    inward = np.arctan((distance - radius) / joining)
    course = np.arctan2(from_centre[1], from_centre[0]) + direction * (0.5 * np.pi + inward)
    near = clip(1.5 - np.abs(distance - radius) / joining, 0.0, 1.0)
    return course, direction * near * ground_speed * ground_speed / np.maximum(distance, radius)


def _climb_control(state: StateArray, climb: Array, airspeed: Array, step: float) -> tuple[Array, Array]:
    """Return pitch and throttle for a climb rate and an airspeed."""
    speed = np.maximum(state.airspeed, 3.0)
    climb_angle = clip(climb / speed, -MAX_CLIMB_ANGLE, MAX_CLIMB_ANGLE)
    angle = np.minimum(
        climb_angle, GLIDE_ANGLE + ANGLE_PER_SPEED * (speed - state.airspeed_min + AIRSPEED_MARGIN)
    )
    angle = np.maximum(angle, ANGLE_PER_SPEED * (speed - state.airspeed_max - 2.0))
    flown = -state.velocity_estimate[2] / speed
    climb_error = angle - flown
    flying = (state.on_ground == 0.0) & (state.mode >= Mode.LINE) & (state.mode <= Mode.CIRCLE)
    state.climb_integral[:] = clip(state.climb_integral + climb_error * (0.4 * step), -0.12, 0.12) * flying
    pressure = state.wing * speed * speed
    lift = np.minimum(GRAVITY / (pressure * np.maximum(np.cos(state.attitude_estimate[0]), 0.5)), MAX_LIFT)
    attack = (lift - LIFT_AT_ZERO) * (1 / LIFT_SLOPE)
    pitch = angle + attack + 0.5 * climb_error + state.climb_integral
    drag = pressure * (DRAG_AT_ZERO + INDUCED_DRAG * lift * lift)
    airspeed_error = airspeed - state.airspeed
    pull = drag + GRAVITY * np.maximum(climb_angle, angle) + clip(0.7 * airspeed_error, -3.0, 3.0)
    state.speed_integral[:] = clip(state.speed_integral + airspeed_error * (0.05 * step), -0.3, 0.3) * flying
    full = state.drive * clip(1.0 - state.airspeed / state.drive_speed, 0.1, 1.0)
    return clip(pitch, -0.5, 0.55), clip(pull / full + state.speed_integral, 0.0, 1.0)


def _yaw_rate(state: StateArray, course: Array, rolling: Mask) -> Array:
    """Return the yaw rate of a coordinated turn; on the ground that of the steered wheel."""
    speed = np.maximum(state.airspeed, 6.0)
    banked = GRAVITY * np.tan(clip(state.attitude_estimate[0], -1.2, 1.2)) / speed
    steered = clip(wrap_angle(course - state.attitude_estimate[2]), -0.6, 0.6)
    moving = np.minimum(horizontal_length(state.velocity_estimate) * 0.2, 1.0)
    return clip(np.where(rolling, steered * moving, banked), -1.5, 1.5)


def _apply_direct_demands(state: StateArray, command: AttitudeCommand) -> AttitudeCommand:
    """Replace the loops' outputs where the demand sets them directly."""
    mode, stick = state.mode, state.stick
    if ((mode >= Mode.LINE) & (mode <= Mode.CIRCLE)).all():
        return command
    attitude, sticks = (mode == Mode.ATTITUDE), (mode == Mode.STICKS)
    off = (mode < Mode.LINE) | (mode == Mode.ROLL_OUT)
    reach = state.rate_limit / state.attitude_gain
    roll, pitch = command.roll, command.pitch
    roll = np.where(attitude, clip(stick[0], -1.2, 1.2), np.where(off, 0.0, roll))
    pitch = np.where(attitude, clip(stick[1], -1.2, 1.2), np.where(off, 0.0, pitch))
    roll = np.where(sticks, state.attitude_estimate[0] + stick[0] * reach[0], roll)
    pitch = np.where(sticks, state.attitude_estimate[1] + stick[1] * reach[1], pitch)
    turn = np.where(sticks, command.turn + stick[2] * state.rate_limit[2], command.turn)
    throttle = np.where(mode > Mode.CIRCLE, stick[3], command.thrust)
    return AttitudeCommand(roll, pitch, turn, np.where(off, 0.0, throttle))
