"""PWM outputs in microseconds, in the usual wiring of each vehicle type.

Motors idle at 1000 and reach full thrust at 2000; control surfaces and reversible motors rest at 1500. An
unused output is 0. Outputs are computed when read, from the present thrust and turning.
"""

from __future__ import annotations

from mavstack.sim.motion.airframes import AIRFRAMES
from mavstack.sim.vehicle_types import VehicleType

OUTPUTS = 16
#: Contribution of each lifting motor of an X quad to roll, pitch and yaw.
QUAD_MIX = ((-1.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, -1.0), (-1.0, -1.0, -1.0))
MIX_GAIN = 0.08


def motor_pulse(share: float) -> float:
    """Return the pulse of a motor that turns one way."""
    return 1000.0 + 1000.0 * min(max(share, 0.0), 1.0)


def surface_pulse(deflection: float) -> float:
    """Return the pulse of a surface or reversible motor."""
    return 1500.0 + 400.0 * min(max(deflection, -1.0), 1.0)


def _quad(turning: tuple[float, float, float], lift: float, running: bool) -> list[float]:
    """Return the pulses of four lifting motors."""
    if not running:
        return [1000.0] * 4
    mixes = (sum(a * b for a, b in zip(mix, turning, strict=True)) for mix in QUAD_MIX)
    return [motor_pulse(max(lift + MIX_GAIN * mix, 0.05)) for mix in mixes]


def _wing(turning: tuple[float, float, float], drive: float) -> list[float]:
    """Return the pulses of aileron, elevator, throttle and rudder."""
    return [
        surface_pulse(turning[0]),
        surface_pulse(turning[1]),
        motor_pulse(drive),
        surface_pulse(turning[2]),
    ]


def outputs(
    vehicle_type: VehicleType, turning: tuple[float, float, float], lift: float, drive: float, running: bool
) -> tuple[int, ...]:
    """Return all outputs in microseconds.

    Args:
        vehicle_type: Selects the wiring.
        turning: Roll, pitch and yaw control, each -1 to 1.
        lift: Share of the full lift.
        drive: Share of the full drive.
        running: True if motors may turn.
    """
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
