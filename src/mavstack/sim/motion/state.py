"""All numbers of all bodies, by name (see `arrays`).

`StateArray` has sections: the rows that a body's readers may see (first, so that one short copy of a column
holds them), internal rows of the step, the demand, faults, and the constants of the airframe with its limits.
Vectors are north, east, down in metres, or roll, pitch, yaw in radians; thrusts are in m/s2 or, where named
so, shares of the full thrust.
"""

from __future__ import annotations

from typing import Annotated

from mavstack.sim.motion.arrays import Array, Quad, Rows, Scalar, Vector
from mavstack.sim.motion.noise import SLOW_NOISES

Gps = Annotated[Array, 6]
SlowNoises = Annotated[Array, SLOW_NOISES]


class StateArray(Rows):
    """Every row."""

    # --- rows that `Body` may read: true motion, in the order of `Motion`
    position: Vector
    velocity: Vector
    acceleration: Vector
    attitude: Vector
    rates: Vector
    # estimates; accelerations and rates have no estimate, because the true values are used
    position_estimate: Vector
    velocity_estimate: Vector
    attitude_estimate: Vector
    position_error: Vector
    drift_velocity: Vector
    yaw_error: Scalar
    gps_lost_time: Scalar
    # environment and actuators
    airspeed: Scalar
    air: Vector
    on_ground: Scalar
    transition: Scalar
    throttle: Scalar
    controls: Vector
    lift_thrust: Scalar
    lift_share: Scalar
    drive_thrust: Scalar
    running: Scalar
    voltage: Scalar
    current: Scalar
    consumed: Scalar
    remaining: Scalar
    temperature: Scalar
    # setpoints of the control loops: Euler angles, the rate of the yaw angle, and body rates
    roll_setpoint: Scalar
    pitch_setpoint: Scalar
    yaw_rate_setpoint: Scalar
    rate_setpoint: Vector
    # last report of the GPS receiver: position and velocity
    gps: Gps
    # corrections: GPS_FIX_TYPE of a receiver with corrections (else 0), and the share of the error that they
    # remove
    gps_fix: Scalar
    gps_precision: Scalar
    # external estimates: whether position, height and heading are used, and their errors; whether GPS is
    # unused
    aid_position: Scalar
    aid_height: Scalar
    aid_heading: Scalar
    aid_offset: Vector
    aid_turn: Scalar
    gps_unused: Scalar
    # faults
    gps_lost: Scalar
    spoof: Vector
    compass_offset: Scalar
    sag: Scalar
    baro_drift: Scalar
    lift_left: Scalar
    drive_left: Scalar
    spin: Scalar
    lean: Vector
    # limits, in the order of `Limits`
    speed: Scalar
    climb: Scalar
    sink: Scalar
    tilt: Scalar
    acceleration_limit: Scalar
    turn_rate: Scalar
    loiter_radius: Scalar
    airspeed_cruise: Scalar
    airspeed_min: Scalar
    airspeed_max: Scalar
    cells: Scalar
    capacity: Scalar

    # --- intermediate values of a step, which `Body` does not read
    gps_pending: Gps
    gps_phase: Scalar
    slow_noise: SlowNoises
    drift_bias: Vector
    sines: Vector
    cosines: Vector
    forward: Vector
    right: Vector
    below: Vector
    force: Vector
    wing_up: Scalar
    authority: Scalar
    power: Scalar
    velocity_setpoint: Vector
    velocity_command: Vector
    acceleration_feedforward: Vector
    integral: Vector
    speed_command: Scalar
    speed_integral: Scalar
    climb_integral: Scalar
    rate_disturbance: Vector
    thrust: Vector

    # --- the present demand, in the order of `Demand`
    mode: Scalar
    target: Vector
    start: Vector
    line_direction: Vector
    line_length: Scalar
    speeds: Quad
    radius: Scalar
    yaw_mode: Scalar
    yaw_demand: Scalar
    stick: Quad
    forward_requested: Scalar

    # --- constants of the airframe
    drag_linear: Scalar
    drag_quadratic: Scalar
    lift: Scalar
    lift_response: Scalar
    drive: Scalar
    drive_speed: Scalar
    drive_response: Scalar
    wing: Scalar
    position_gain: Scalar
    velocity_gain: Scalar
    integral_gain: Scalar
    heave_gain: Scalar
    attitude_gain: Scalar
    rate_limit: Vector
    rate_response: Scalar
    angular_acceleration: Scalar
    floor: Scalar
    ceiling: Scalar
    friction: Scalar
    rest_pitch: Scalar
    power_idle: Scalar
    power_lift: Scalar
    power_drive: Scalar
    resistance: Scalar


#: Number of rows that `Body` may read: all rows before the intermediate values.
PUBLISHED = StateArray.ROWS["gps_pending"][0]
