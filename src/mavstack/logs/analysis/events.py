"""Rules about what the vehicle reported: errors, failsafes, crashes, refused modes, parameters."""

from __future__ import annotations

import re
from math import isfinite
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.analysis.findings import Finding, Severity
from mavstack.logs.analysis.rules import Rule

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.logs.analysis.flight import Flight
    from mavstack.logs.records import LogText

_FAILSAFE: Final = re.compile(r"fail-?safe|emergency", re.IGNORECASE)
_CLEARED: Final = re.compile(
    r"\b(clear(ed)?|off|end(ed)?|recover(ed|y)?|cancel(l?ed)?|restored)\b", re.IGNORECASE
)
#: Texts that explain why a vehicle on the ground refuses to arm, such as "PreArm: CrashDump data detected".
_REFUSED: Final = re.compile(r"(pre-?arm|arm|preflight fail|arming denied)\b[^:]*:", re.IGNORECASE)
_CRASH: Final = re.compile(r"crash|potential thrust loss|engine failure", re.IGNORECASE)
#: "Mode change to LOITER failed: requires position" (ArduPilot), "Switching to Mission is currently not
#: available" and "Switching to mode 'Mission' is currently not possible" (PX4).
_MODE_FAILED: Final = re.compile(
    r"mode change to .* failed|switching to .* not (possible|available)|\bmode\b.* (rejected|denied)",
    re.IGNORECASE,
)
#: Subsystem FLIGHT_MODE in ArduPilot's ERR records; ECode is the mode that was refused.
_FLIGHT_MODE_SUBSYSTEM: Final = 10
#: Texts that other rules than `errors` report.
_OF_OTHER_RULES: Final = (_FAILSAFE, _CRASH, _MODE_FAILED)
_ERROR_SEVERITY: Final = 3
_MAX_LISTED: Final = 5
#: Parameters that the vehicle changes itself.
_AUTOMATIC: Final = ("STAT_", "BARO", "GND_", "SYS_NUM_RESETS")
#: Roll or pitch in degrees that a multirotor exceeds only when it falls.
_UPSIDE_DOWN: Final = 80.0


def failsafes(flight: Flight) -> Iterator[Finding]:
    """Look for texts that tell a failsafe, and for errors of DataFlash logs (ERR)."""
    yield from _reported(flight, "failsafes", _is_failsafe)
    if "ERR" in flight.log and flight.log.schema("ERR").has_numbers("Subsys", "ECode"):
        errors = flight.log["ERR"]
        errors = errors.where((errors["ECode"] != 0) & (errors["Subsys"] != _FLIGHT_MODE_SUBSYSTEM))
        times = flight.log.seconds_from_start("ERR", errors)
        for row, time in zip(errors[:_MAX_LISTED], times.tolist(), strict=False):
            title = f"error: subsystem {row['Subsys']}, code {row['ECode']}"
            report = (
                "The vehicle logged an error (ERR); ArduPilot's documentation lists subsystems and codes."
            )
            yield Finding("failsafes", Severity.WARNING, title, report, _known(time))


def crash(flight: Flight) -> Iterator[Finding]:
    """Look for texts that tell a crash or a loss of thrust, and for a multirotor beyond 80 degrees."""
    yield from _reported(flight, "crash", _is_crash)
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


def mode_failures(flight: Flight) -> Iterator[Finding]:
    """Look for modes that the vehicle refused to enter: texts, and errors of DataFlash logs (ERR)."""
    texts = _first_times([(time, text) for time, text in flight.texts if _MODE_FAILED.search(text.text)])
    for title, time in texts.items():
        report = f"The vehicle stayed in its mode: {title}"
        yield Finding("mode_failures", Severity.WARNING, title, report, _known(time))
    # Status texts also give the reason, so ERR records are read only without them.
    if texts or "ERR" not in flight.log or not flight.log.schema("ERR").has_numbers("Subsys", "ECode"):
        return
    rows = flight.log["ERR"]
    rows = rows.where(rows["Subsys"] == _FLIGHT_MODE_SUBSYSTEM)
    times = flight.log.seconds_from_start("ERR", rows)
    for row, time in zip(rows[:_MAX_LISTED], times.tolist(), strict=False):
        mode = int(row["ECode"])
        title = f"change to mode {mode} failed"
        report = f"The vehicle refused to enter mode {mode} and logged an error (ERR)."
        yield Finding("mode_failures", Severity.WARNING, title, report, _known(time), {"mode": float(mode)})


def errors(flight: Flight) -> Iterator[Finding]:
    """List texts of severity ERROR and above; failsafes, crashes and modes are findings of their own."""
    grave = [
        (time, text)
        for time, text in flight.texts
        if text.severity <= _ERROR_SEVERITY
        and (_REFUSED.match(text.text) or not any(found.search(text.text) for found in _OF_OTHER_RULES))
    ]
    distinct = _first_times(grave)
    for title, time in list(distinct.items())[:_MAX_LISTED]:
        yield Finding("errors", Severity.WARNING, title, f"The vehicle reported: {title}", _known(time))
    if len(distinct) > _MAX_LISTED:
        title = f"{len(distinct) - _MAX_LISTED} more errors reported"
        yield Finding("errors", Severity.WARNING, title, "The report lists all texts.", None)


def parameter_changes(flight: Flight) -> Iterator[Finding]:
    """List parameters that were changed in flight."""
    changes = [
        (time, change)
        for time, change in flight.parameter_changes
        if isfinite(time) and not change.name.startswith(_AUTOMATIC)
    ]
    flying = flight.is_flying(np.array([time for time, _ in changes], np.float64)).tolist()
    in_flight = [item for item, now in zip(changes, flying, strict=True) if now]
    if in_flight:
        listed = ", ".join(f"{change.name} = {change.value:g}" for _, change in in_flight[:10])
        text = f"Changed in flight: {listed}."
        noun = "parameter" if len(in_flight) == 1 else "parameters"
        title = f"{len(in_flight)} {noun} changed in flight"
        numbers = {"changes": float(len(in_flight))}
        yield Finding("parameter_changes", Severity.INFO, title, text, in_flight[0][0], numbers)


def _is_failsafe(text: str) -> bool:
    return bool(_FAILSAFE.search(text)) and not _CLEARED.search(text) and not _REFUSED.match(text)


def _is_crash(text: str) -> bool:
    return bool(_CRASH.search(text)) and not _REFUSED.match(text)


def _reported(flight: Flight, rule: str, concerns: Callable[[str], bool]) -> Iterator[Finding]:
    """Yield a critical finding for each distinct text, at its first time."""
    found = _first_times([(time, text) for time, text in flight.texts if concerns(text.text)])
    for title, time in found.items():
        yield Finding(rule, Severity.CRITICAL, title, f"The vehicle reported: {title}", _known(time))


def _first_times(texts: list[tuple[float, LogText]]) -> dict[str, float]:
    found: dict[str, float] = {}
    for time, text in texts:
        found.setdefault(text.text, time)
    return found


def _known(time: float) -> float | None:
    return float(time) if np.isfinite(time) else None


RULES: Final = (
    Rule("failsafes", str(failsafes.__doc__), failsafes),
    Rule("crash", str(crash.__doc__), crash),
    Rule("mode_failures", str(mode_failures.__doc__), mode_failures),
    Rule("errors", str(errors.__doc__), errors),
    Rule("parameter_changes", str(parameter_changes.__doc__), parameter_changes),
)
