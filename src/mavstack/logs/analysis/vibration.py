"""Rules about vibration: its strength, and accelerometers that reach the end of their range."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.analysis.findings import Finding, Severity
from mavstack.logs.analysis.rules import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.logs.analysis.flight import Flight

#: m/s/s below which ArduPilot's documentation calls vibration acceptable, and above which it calls it bad.
_ACCEPTABLE: Final = 30.0
_BAD: Final = 60.0
#: Number of clipped samples that is usual at a landing.
_FEW_CLIPS: Final = 30


def vibration(flight: Flight) -> Iterator[Finding]:
    """Look for vibration above 30 m/s/s (warning) or 60 m/s/s (critical) on any axis in flight."""
    for axis in ("x", "y", "z"):
        signal = flight.flying_signal(f"vibration_{axis}")
        if signal is None:
            continue
        # A single peak of a landing or a crash is not a vibration, so the 95th percentile counts.
        level, top = float(np.percentile(signal.values, 95)), float(signal.values.max())
        if level < _ACCEPTABLE:
            continue
        grave = level >= _BAD
        yield Finding(
            "vibration",
            Severity.CRITICAL if grave else Severity.WARNING,
            f"vibration on {axis}: {level:.0f} m/s/s",
            f"For 5 % of the flight the vibration on the {axis} axis is at least {level:.0f} m/s/s (highest "
            f"{top:.0f}). Below {_ACCEPTABLE:.0f} is acceptable; above {_BAD:.0f} the estimates of altitude "
            "and position become wrong. Balance the propellers, and look at the mount of the autopilot.",
            float(signal.times[signal.values.argmax()]),
            {"level_m_s2": level, "max_m_s2": top},
        )


def clipping(flight: Flight) -> Iterator[Finding]:
    """Look for samples of the accelerometer that reached the end of its range while armed."""
    steps = flight.armed_steps("clipping")
    rises = None if steps is None else steps.during(steps.values > 0)
    if rises is None or not len(rises):
        return
    clipped, first = float(rises.values.sum()), float(rises.times[0])
    yield Finding(
        "clipping",
        Severity.CRITICAL if clipped > _FEW_CLIPS else Severity.INFO,
        f"{clipped:.0f} clipped samples of the accelerometer",
        f"The accelerometer reached the end of its range {clipped:.0f} times while armed. A few on landing "
        "are usual; more of them falsify the estimates of altitude and position.",
        first,
        {"samples": clipped},
    )


RULES: Final = (
    Rule("vibration", str(vibration.__doc__), vibration),
    Rule("clipping", str(clipping.__doc__), clipping),
)
