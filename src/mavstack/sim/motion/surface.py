"""Rovers and boats: turned to where the velocity wanted points, and driven along their heading.

Both can turn on the spot, so that every point is reached: the more the heading is off, the slower they go.
A motor pulls drive x (throttle - speed / drive_speed), as an electric one does. Wheels hardly slip
sideways; a hull does, and the wind pushes it, so that a boat goes back to its place again and again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, bounded, dot, wrapped
from mavstack.sim.motion.battery import GRAVITY, strength
from mavstack.sim.motion.demands import Mode, YawMode

if TYPE_CHECKING:
    from mavstack.sim.motion.fleet import Fleet

#: How near the end of a line is there, and how far it may drift before it goes back, in seconds of its
#: position gain: a hull is given more.
THERE, BACK = 0.28, 0.8
STANDSTILL = 0.02
SPEED_GAIN = 1.5
#: Of the throttle.
NEARLY_ALL = 0.95
#: Sideways drag in 1/s: wheels and hull.
GRIP, HULL = 12.0, 1.0


def control(fleet: Fleet, step: float) -> tuple[Array, Array]:
    """Give the yaw rate and the throttle (-1..1) wanted."""
    wanted, yaw = fleet.velocity_wanted, fleet.attitude_estimate[2]
    size = np.sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1])
    off = fleet.target[:2] - fleet.position_estimate[:2]
    near = np.where(fleet.speed_command > STANDSTILL, THERE, BACK) / fleet.position_gain
    there = (fleet.mode == Mode.LINE) & (off[0] * off[0] + off[1] * off[1] < near * near)
    size = np.where(there | (size < STANDSTILL), 0.0, size)
    moving = (size > 0.0) & (fleet.mode >= Mode.LINE) & (fleet.mode <= Mode.CIRCLE)
    heading = np.where(moving, np.arctan2(wanted[1], wanted[0]), fleet.yaw_demand)
    told = fleet.yaw_mode == YawMode.RATE
    ahead = (wrapped(heading - yaw)) * (moving | (fleet.yaw_mode == YawMode.HOLD))
    turn = np.where(told, fleet.yaw_demand, fleet.attitude_gain * ahead)
    speed = size * np.maximum(np.where(told, 1.0, np.cos(ahead)), 0.0) ** 2
    speed = np.where(np.abs(ahead) > 1.0, np.where(told, speed, 0.0), speed)
    throttle = _throttle(fleet, speed, step)
    return _by_hand(fleet, turn, throttle)


def _throttle(fleet: Fleet, speed: Array, step: float) -> Array:
    """Hold a speed along the heading, approached no faster than allowed."""
    most = fleet.acceleration_limit * step
    now = dot(fleet.velocity_estimate, fleet.forward)
    guided = (fleet.mode >= Mode.LINE) & (fleet.mode <= Mode.CIRCLE)
    command = fleet.speed_command
    change = bounded(speed - command, -2.0 * most, most)
    command += change
    np.copyto(command, now, where=~guided)
    error = command - now
    moving = guided & (command > STANDSTILL)
    # a motor that gives all it has, or is still speeding up, tells nothing about drag and slope
    learnt = error * (0.4 * step) * ((np.abs(change) < most) & (np.abs(fleet.drive_thrust) < NEARLY_ALL))
    fleet.speed_integral[:] = bounded(fleet.speed_integral + learnt, -0.5, 0.5) * moving
    ahead = (SPEED_GAIN * error + bounded(change, -most, most) / step * guided) / fleet.drive
    return command / fleet.drive_speed + ahead + fleet.speed_integral


def _by_hand(fleet: Fleet, turn: Array, throttle: Array) -> tuple[Array, Array]:
    """Replace what the loops want where the demand says it directly."""
    mode, stick, limit = fleet.mode, fleet.stick, fleet.turn_rate
    sticks, rates = (mode == Mode.STICKS), (mode == Mode.RATES)
    off = (mode < Mode.LINE) | (mode == Mode.ROLL_OUT)
    turn = np.where(sticks, (stick[0] + stick[2]) * limit, np.where(rates, stick[2], turn))
    throttle = np.where(mode > Mode.CIRCLE, stick[3], throttle)
    still = np.where(off, 0.0, 1.0)
    return bounded(turn * still, -limit, limit), bounded(throttle * still, -1.0, 1.0)


def move(fleet: Fleet, turn: Array, throttle: Array, grip: float, step: float) -> None:
    """Turn, and add the forces of motor, ground or water."""
    fleet.rates[2] += bounded(
        (turn * fleet.drive_left - fleet.rates[2]) * fleet.rate_response,
        -fleet.angular_acceleration * step,
        fleet.angular_acceleration * step,
    )
    aim = throttle * strength(fleet) * fleet.drive_left
    fleet.drive_thrust += (aim - fleet.drive_thrust) * fleet.drive_response
    ahead, aside = dot(fleet.velocity, fleet.forward), dot(fleet.velocity, fleet.right)
    fleet.force += fleet.forward * (fleet.drive * (fleet.drive_thrust - ahead / fleet.drive_speed))
    fleet.force -= fleet.right * (grip * aside)
    fleet.force[2] = -GRAVITY
