"""Rules about the motors of multirotors: outputs at their limit, and outputs that differ."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.logs.analysis.findings import Finding, Severity
from mavstack.logs.analysis.rules import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.logs.analysis.flight import Flight
    from mavstack.logs.analysis.signals import Signal

#: Pulse width in microseconds from which a motor has no reserve, and from which it turns.
_FULL: Final = 1950.0
_TURNING: Final = 1150.0
_SATURATED_SHARE: Final = 0.05
#: Difference of the mean pulse widths in microseconds that a balanced vehicle does not reach.
_IMBALANCE: Final = 150.0
_MIN_SAMPLES: Final = 20
_ROTORS: Final = {"QUADROTOR": 4, "HEXAROTOR": 6, "OCTOROTOR": 8, "TRICOPTER": 3}


def motor_saturation(flight: Flight) -> Iterator[Finding]:
    """Look for motors of a multirotor that are at their limit for more than 5 % of the flight."""
    for motor in _motors(flight):
        share = float((motor.values >= _FULL).mean())
        if share > _SATURATED_SHARE:
            yield Finding(
                "motor_saturation",
                Severity.CRITICAL,
                f"{motor.title} at its limit for {share:.0%} of the flight",
                f"{motor.title.capitalize()} was at {_FULL:.0f} us or more for {share:.0%} of the flight: "
                "the vehicle is too heavy, a motor or propeller is damaged, or the wind was too strong. It "
                "cannot hold its attitude when another motor needs more.",
                float(motor.times[motor.values.argmax()]),
                {"share": share},
            )


def motor_imbalance(flight: Flight) -> Iterator[Finding]:
    """Look for means of the motors of a multirotor that differ by more than 150 us."""
    motors = list(_motors(flight))
    if len(motors) < 2:
        return
    means = {motor.title: float(motor.values.mean()) for motor in motors}
    high, low = max(means, key=means.__getitem__), min(means, key=means.__getitem__)
    difference = means[high] - means[low]
    if difference > _IMBALANCE:
        yield Finding(
            "motor_imbalance",
            Severity.WARNING,
            f"motors differ by {difference:.0f} us",
            f"On average {high} ran at {means[high]:.0f} us and {low} at {means[low]:.0f} us. The centre of "
            "mass is off, a motor is tilted, or one is weaker than the others.",
            None,
            {"difference_us": difference},
        )


def _motors(flight: Flight) -> Iterator[Signal]:
    """Yield the outputs of the motors of a multirotor that turn in flight."""
    if not flight.is_multirotor:
        return
    for number in range(1, _ROTORS.get(flight.vehicle_type, 0) + 1):
        signal = flight.flying_signal(f"output_{number}")
        if signal is None:
            continue
        turning = signal.during(signal.values > _TURNING)
        if len(turning) >= _MIN_SAMPLES:
            yield turning


RULES: Final = (
    Rule("motor_saturation", str(motor_saturation.__doc__), motor_saturation),
    Rule("motor_imbalance", str(motor_imbalance.__doc__), motor_imbalance),
)
