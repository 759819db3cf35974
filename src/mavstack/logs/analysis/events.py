"""Rules about what the vehicle reported: errors, failsafes, crashes, and parameters changed in flight."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.analysis.findings import Finding, Severity
from mavstack.logs.analysis.rules import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.logs.analysis.flight import Flight

_FAILSAFE: Final = re.compile(r"fail-?safe|emergency", re.IGNORECASE)
_CLEARED: Final = re.compile(r"clear|off|end|recover|cancel|restored", re.IGNORECASE)
_CRASH: Final = re.compile(r"crash|potential thrust loss|engine failure", re.IGNORECASE)
_ERROR_SEVERITY: Final = 3
_MAX_LISTED: Final = 5
#: Parameters that the vehicle changes itself.
_AUTOMATIC: Final = ("STAT_", "BARO", "GND_", "SYS_NUM_RESETS")
#: Degrees of roll or pitch that a multirotor does not reach unless it falls.
_UPSIDE_DOWN: Final = 80.0


def failsafes(flight: Flight) -> Iterator[Finding]:
    """Look for texts that tell a failsafe, and for errors of DataFlash logs (ERR)."""
    for time, text in flight.texts:
        if _FAILSAFE.search(text.text) and not _CLEARED.search(text.text):
            report = f"The vehicle reported: {text.text}"
            yield Finding("failsafes", Severity.CRITICAL, text.text, report, _known(time))
    if "ERR" in flight.log:
        errors = flight.log["ERR"]
        errors = errors.where(errors["ECode"] != 0)
        times = flight.log.seconds_from_start("ERR", errors)
        for row, time in zip(errors[:_MAX_LISTED], times.tolist(), strict=False):
            title = f"error: subsystem {row['Subsys']}, code {row['ECode']}"
            report = (
                "The vehicle logged an error (ERR); ArduPilot's documentation lists subsystems and codes."
            )
            yield Finding("failsafes", Severity.WARNING, title, report, _known(time))


def crash(flight: Flight) -> Iterator[Finding]:
    """Look for texts that tell a crash or a loss of thrust, and for a multirotor beyond 80 degrees."""
    for time, text in flight.texts:
        if _CRASH.search(text.text):
            report = f"The vehicle reported: {text.text}"
            yield Finding("crash", Severity.CRITICAL, text.text, report, _known(time))
    if not flight.is_multirotor:
        return
    for name in ("roll", "pitch"):
        signal = flight.armed_signal(name)
        if signal is None:
            continue
        top = float(np.abs(signal.values).max())
        if top > _UPSIDE_DOWN:
            report = (
                f"The {name} angle reached {top:.0f} degrees while armed: it tumbled, or flew acrobatics."
            )
            time = float(signal.times[np.abs(signal.values).argmax()])
            title = f"{name} of {top:.0f} degrees"
            yield Finding("crash", Severity.CRITICAL, title, report, time, {"angle_deg": top})


def errors(flight: Flight) -> Iterator[Finding]:
    """List texts of severity ERROR and above; failsafes and crashes are findings of their own."""
    grave = [
        (time, text)
        for time, text in flight.texts
        if text.severity <= _ERROR_SEVERITY
        and not _FAILSAFE.search(text.text)
        and not _CRASH.search(text.text)
    ]
    distinct: dict[str, float] = {}
    for time, text in grave:
        distinct.setdefault(text.text, time)
    for title, time in list(distinct.items())[:_MAX_LISTED]:
        yield Finding("errors", Severity.WARNING, title, f"The vehicle reported: {title}", _known(time))
    if len(distinct) > _MAX_LISTED:
        title = f"{len(distinct) - _MAX_LISTED} more errors reported"
        yield Finding("errors", Severity.WARNING, title, "The report lists all texts.", None)


def parameter_changes(flight: Flight) -> Iterator[Finding]:
    """List parameters that were changed while armed."""
    changes = [
        (time, change)
        for time, change in flight.parameter_changes
        if np.isfinite(time) and not change.name.startswith(_AUTOMATIC)
    ]
    armed = flight.is_armed(np.array([time for time, _ in changes], np.float64)).tolist()
    in_flight = [item for item, now in zip(changes, armed, strict=True) if now]
    if in_flight:
        listed = ", ".join(f"{change.name} = {change.value:g}" for _, change in in_flight[:10])
        text = f"Changed while armed: {listed}."
        title = f"{len(in_flight)} parameters changed in flight"
        numbers = {"changes": float(len(in_flight))}
        yield Finding("parameter_changes", Severity.INFO, title, text, in_flight[0][0], numbers)


def _known(time: float) -> float | None:
    return float(time) if np.isfinite(time) else None


RULES: Final = (
    Rule("failsafes", str(failsafes.__doc__), failsafes),
    Rule("crash", str(crash.__doc__), crash),
    Rule("errors", str(errors.__doc__), errors),
    Rule("parameter_changes", str(parameter_changes.__doc__), parameter_changes),
)
