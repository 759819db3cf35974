"""PWM outputs in microseconds as an autopilot of each type would wire them.

Motors idle at 1000 and are full at 2000; surfaces and motors that reverse rest at 1500. An output nobody
uses is 0. Worked out when read, from thrust and turning of the moment.
"""

from __future__ import annotations

from mavstack.sim.motion.airframes import AIRFRAMES
from mavstack.sim.vehicle_types import VehicleType

OUTPUTS = 16
#: How each lifting motor_pulse of an X quad helps roll, pitch and yaw.
QUAD_MIX = ((-1.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, -1.0), (-1.0, -1.0, -1.0))
MIX_GAIN = 0.08


def motor_pulse(share: float) -> float:
    """Pulse of a motor_pulse that turns one way."""
    return 1000.0 + 1000.0 * min(max(share, 0.0), 1.0)


def surface_pulse(deflection: float) -> float:
    """Pulse of what goes both ways."""
    return 1500.0 + 400.0 * min(max(deflection, -1.0), 1.0)


def _quad(turning: tuple[float, float, float], lift: float, running: bool) -> list[float]:
    if not running:
        return [1000.0] * 4
    mixes = (sum(a * b for a, b in zip(mix, turning, strict=True)) for mix in QUAD_MIX)
    return [motor_pulse(max(lift + MIX_GAIN * mix, 0.05)) for mix in mixes]


def _wing(turning: tuple[float, float, float], drive: float) -> list[float]:
    return [
        surface_pulse(turning[0]),
        surface_pulse(turning[1]),
        motor_pulse(drive),
        surface_pulse(turning[2]),
    ]


def outputs(
    vehicle_type: VehicleType, turning: tuple[float, float, float], lift: float, drive: float, running: bool
) -> tuple[int, ...]:
    """Give all outputs; `turning` is -1..1 about roll, pitch and yaw."""
    match vehicle_type:
        case VehicleType.COPTER:
            pulses = _quad(turning, lift, running)
        case VehicleType.PLANE:
            pulses = _wing(turning, drive)
        case VehicleType.VTOL:
            pulses = _wing(turning, drive) + _quad(turning, lift, running)
        case VehicleType.SUB:
            pulses = [surface_pulse(lift * 0.5 + 0.1 * sum(turning))] * AIRFRAMES[vehicle_type].motors
        case _:
            pulses = [surface_pulse(drive + 0.3 * turning[2]), 0.0, surface_pulse(drive - 0.3 * turning[2])]
    whole = [round(pulse) for pulse in pulses]
    return tuple(whole + [0] * (OUTPUTS - len(whole)))
