"""Airframe constants of each vehicle type, close to vehicles that are on the market.

- copter: a quad of 1.5 kg on 4 cells, hovering at half its thrust;
- plane: a foam wing of 1.2 m, 1.5 kg, that stalls at 10 m/s and cruises at 18;
- vtol: a quadplane of 5 kg with four lifting motors and a pusher;
- rover: a skid-steered cart; boat: differential thrust, drifting with the wind;
- sub: six degrees of freedom in water, slightly buoyant.

Forces are per mass (m/s2), so that the mass appears nowhere. A wing is given by rho S / 2 m: its lift is wing
x airspeed squared x lift coefficient.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from mavstack.sim.vehicle_types import VehicleType


@dataclass(frozen=True, slots=True)
class Airframe:
    """Performance limits, force coefficients, control gains and battery of a vehicle type."""

    # limits that parameters of the autopilot may change
    speed: float
    climb: float
    sink: float
    acceleration: float
    loiter_radius: float
    tilt: float = 0.6
    turn_rate: float = 1.6
    airspeed_cruise: float = 0.0
    airspeed_min: float = 0.0
    airspeed_max: float = 0.0
    # maximum speeds, which no demand can exceed
    top_speed: float = 20.0
    top_climb: float = 8.0
    # forces: drag in air; lifting motors at full thrust; driving motor at full thrust and standstill
    drag_linear: float = 0.0
    drag_quadratic: float = 0.0
    lift: float = 0.0
    lift_lag: float = 0.06
    drive: float = 0.0
    drive_speed: float = 1.0
    drive_lag: float = 0.2
    wing: float = 0.0
    # control loops
    position_gain: float = 1.0
    velocity_gain: float = 2.0
    integral_gain: float = 0.5
    heave_gain: float = 3.5
    attitude_gain: float = 6.0
    roll_rate: float = 3.8
    pitch_rate: float = 3.8
    yaw_rate: float = 2.0
    rate_lag: float = 0.05
    angular_acceleration: float = 60.0
    # environment: lowest and highest position (metres down), friction on the ground, pitch at rest
    floor: float = 0.0
    ceiling: float = -1e6
    friction: float = 6.0
    rest_pitch: float = 0.0
    # battery
    power_idle: float = 6.0
    power_lift: float = 0.0
    power_drive: float = 0.0
    cells: float = 4.0
    capacity: float = 5200.0
    resistance: float = 0.025
    # number of motors that can fail
    motors: int = 4


AIRFRAMES: dict[VehicleType, Airframe] = {
    VehicleType.COPTER: Airframe(
        speed=10.0,
        climb=2.5,
        sink=1.5,
        acceleration=2.5,
        loiter_radius=10.0,
        top_speed=18.0,
        top_climb=8.0,
        drag_linear=0.1,
        drag_quadratic=0.012,
        lift=2 * 9.80665,
        power_lift=480.0,
    ),
    VehicleType.PLANE: Airframe(
        speed=18.0,
        climb=4.0,
        sink=3.0,
        acceleration=2.0,
        loiter_radius=60.0,
        tilt=math.radians(45),
        airspeed_cruise=18.0,
        airspeed_min=13.0,
        airspeed_max=28.0,
        top_speed=28.0,
        top_climb=5.0,
        drive=9.0,
        drive_speed=35.0,
        wing=0.0755,
        attitude_gain=4.0,
        roll_rate=1.6,
        pitch_rate=1.0,
        yaw_rate=1.0,
        rate_lag=0.12,
        angular_acceleration=15.0,
        friction=0.4,
        rest_pitch=0.2,
        power_drive=320.0,
        capacity=4000.0,
        motors=1,
    ),
    VehicleType.VTOL: Airframe(
        speed=8.0,
        climb=2.5,
        sink=1.5,
        acceleration=3.0,
        loiter_radius=80.0,
        tilt=0.5,
        airspeed_cruise=20.0,
        airspeed_min=15.0,
        airspeed_max=28.0,
        top_speed=12.0,
        top_climb=5.0,
        drag_linear=0.02,
        drag_quadratic=0.002,
        lift=2 * 9.80665,
        drive=8.0,
        drive_speed=40.0,
        wing=0.0524,
        attitude_gain=4.5,
        roll_rate=2.5,
        pitch_rate=2.0,
        yaw_rate=1.2,
        rate_lag=0.08,
        angular_acceleration=25.0,
        power_lift=2260.0,
        power_drive=600.0,
        cells=6.0,
        capacity=12000.0,
        resistance=0.015,
        motors=5,
    ),
    VehicleType.ROVER: Airframe(
        speed=3.0,
        climb=0.5,
        sink=0.5,
        acceleration=1.5,
        loiter_radius=5.0,
        turn_rate=2.0,
        top_speed=5.0,
        drive=5.0,
        drive_speed=7.0,
        position_gain=0.8,
        attitude_gain=2.5,
        yaw_rate=2.0,
        rate_lag=0.15,
        angular_acceleration=15.0,
        ceiling=0.0,
        friction=0.0,
        power_drive=150.0,
        cells=3.0,
        capacity=5000.0,
        motors=2,
    ),
    VehicleType.BOAT: Airframe(
        speed=2.0,
        climb=0.5,
        sink=0.5,
        acceleration=0.6,
        loiter_radius=8.0,
        turn_rate=0.9,
        top_speed=3.0,
        drag_linear=0.02,
        drag_quadratic=0.002,
        drive=1.8,
        drive_speed=4.0,
        position_gain=0.4,
        velocity_gain=1.5,
        attitude_gain=1.5,
        yaw_rate=0.9,
        rate_lag=0.4,
        angular_acceleration=3.0,
        ceiling=0.0,
        friction=0.0,
        power_drive=220.0,
        capacity=10000.0,
        motors=2,
    ),
    VehicleType.SUB: Airframe(
        speed=1.0,
        climb=0.5,
        sink=0.5,
        acceleration=0.5,
        loiter_radius=3.0,
        turn_rate=0.8,
        top_speed=1.5,
        top_climb=1.0,
        lift=1.2,
        lift_lag=0.15,
        position_gain=0.8,
        velocity_gain=1.6,
        integral_gain=0.3,
        heave_gain=1.6,
        attitude_gain=2.5,
        roll_rate=1.0,
        pitch_rate=1.0,
        yaw_rate=0.8,
        rate_lag=0.2,
        angular_acceleration=4.0,
        floor=40.0,
        ceiling=0.0,
        friction=0.5,
        power_idle=12.0,
        power_lift=200.0,
        capacity=15600.0,
        motors=6,
    ),
}

#: Minimum and maximum of each limit: values outside of them could make a control loop unstable.
LIMIT_RANGES: dict[str, tuple[float, float]] = {
    "speed": (0.1, 60.0),
    "climb": (0.1, 20.0),
    "sink": (0.1, 20.0),
    "tilt": (0.1, 1.1),
    "acceleration": (0.1, 10.0),
    "turn_rate": (0.1, 6.0),
    "loiter_radius": (1.0, 10_000.0),
    "airspeed_cruise": (0.0, 80.0),
    "airspeed_min": (0.0, 60.0),
    "airspeed_max": (0.0, 80.0),
}


def limit_range(vehicle_type: VehicleType, name: str) -> tuple[float, float]:
    """Return the minimum and maximum of a limit.

    The airspeed limits of a wing stay above its stall speed and below the speed that its drag allows.
    """
    low, high = LIMIT_RANGES[name]
    airframe = AIRFRAMES[vehicle_type]
    slow, fast = airframe.airspeed_min, airframe.airspeed_max
    match name:
        case "speed" if vehicle_type is VehicleType.PLANE:
            return slow, fast
        case "speed":
            return low, airframe.top_speed
        case "airspeed_min" if fast:
            return 0.95 * slow, 0.7 * fast
        case "airspeed_cruise" | "airspeed_max" if fast:
            return slow, fast
    return low, high
