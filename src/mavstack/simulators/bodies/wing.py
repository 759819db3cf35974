"""The air around a small plane: lift, drag and moments by coefficients.

Moments are linear in the angles of attack and sideslip, the turn rates and the surfaces. Lift falls off
beyond the stall.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from mavstack.rotation import Vector

#: Wing area (m2), span and chord (m).
AREA, SPAN, CHORD = 0.4, 1.5, 0.27
DENSITY: Final = 1.225
#: Lift coefficient at zero angle of attack, and its increase per radian up to the stall angle (radians);
#: its decrease per radian beyond the stall angle.
LIFT_ZERO, LIFT_SLOPE, STALL, STALLED_SLOPE = 0.25, 4.8, 0.26, 2.7
#: Drag coefficients: of the frame, and per square of the lift coefficient.
DRAG_ZERO, DRAG_INDUCED = 0.03, 0.05
SIDE_SLOPE: Final = -0.5
#: Pitching moment coefficients: at zero, per angle of attack, rate and elevator (positive: nose up).
PITCH_ZERO, PITCH_SLOPE, PITCH_DAMPING, PITCH_CONTROL = 0.009, -0.6, -12.0, 0.45
#: Rolling moment coefficients: per sideslip, rate and aileron (positive: right wing down).
ROLL_SLOPE, ROLL_DAMPING, ROLL_CONTROL = -0.05, -0.5, 0.15
#: Yawing moment coefficients: per sideslip, rate and rudder (positive: nose right).
YAW_SLOPE, YAW_DAMPING, YAW_CONTROL = 0.08, -0.12, 0.06
#: Airspeed in m/s below which no aerodynamic forces are computed.
_MIN_SPEED: Final = 0.5


def wing_forces(flow: Vector, rates: Vector, surfaces: tuple[float, float, float]) -> tuple[Vector, Vector]:
    """Return force (newtons) and torque (newton metres) of the air in body axes.

    Args:
        flow: Velocity through the air in body axes in m/s.
        rates: Turn rates in rad/s.
        surfaces: Aileron, elevator and rudder, -1 to 1.
    """
    speed = math.hypot(*flow)
    if speed < _MIN_SPEED:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    u, v, w = flow
    alpha, beta = math.atan2(w, u), math.asin(max(-1.0, min(1.0, v / speed)))
    pressure = 0.5 * DENSITY * speed * speed * AREA
    lift = _lift(alpha)
    drag = DRAG_ZERO + DRAG_INDUCED * lift * lift + max(abs(alpha) - STALL, 0.0)
    ca, sa = math.cos(alpha), math.sin(alpha)
    force = (
        pressure * (lift * sa - drag * ca),
        pressure * SIDE_SLOPE * beta,
        pressure * (-lift * ca - drag * sa),
    )
    p, q, r = rates
    aileron, elevator, rudder = surfaces
    across, along = 0.5 * SPAN / speed, 0.5 * CHORD / speed
    bounded = max(-STALL, min(STALL, alpha))
    roll = ROLL_SLOPE * beta + ROLL_DAMPING * p * across + ROLL_CONTROL * aileron
    pitch = PITCH_ZERO + PITCH_SLOPE * bounded + PITCH_DAMPING * q * along + PITCH_CONTROL * elevator
    yaw = YAW_SLOPE * beta + YAW_DAMPING * r * across + YAW_CONTROL * rudder
    return force, (pressure * SPAN * roll, pressure * CHORD * pitch, pressure * SPAN * yaw)


def _lift(alpha: float) -> float:
    """Return the lift coefficient at an angle of attack in radians."""
    if alpha > STALL:
        return max(LIFT_ZERO + LIFT_SLOPE * STALL - STALLED_SLOPE * (alpha - STALL), 0.0)
    if alpha < -STALL:
        return min(LIFT_ZERO - LIFT_SLOPE * STALL - STALLED_SLOPE * (alpha + STALL), 0.0)
    return LIFT_ZERO + LIFT_SLOPE * alpha
