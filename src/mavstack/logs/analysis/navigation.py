"""Rules about navigation: satellites, jumps of the position, and the estimator."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.analysis.findings import Finding, Severity
from mavstack.logs.analysis.rules import Rule
from mavstack.logs.tracks import distances

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.logs.analysis.flight import Flight

_FIX_3D: Final = 3
_FEW_SATELLITES: Final = 6
_POOR_HDOP: Final = 2.0
#: Maximum speed in m/s, and maximum noise in metres, of two positions in sequence.
_MAX_SPEED: Final = 100.0
_POSITION_NOISE: Final = 15.0
#: Test ratio above which ArduPilot's EKF failsafe acts (FS_EKF_THRESH); at 1 a measurement is rejected.
_HIGH_RATIO: Final = 0.8
_REJECTED: Final = 1.0
#: Seconds for which a test ratio must be high; short spikes are usual.
_RATIO_TIME: Final = 1.0


def gps_quality(flight: Flight) -> Iterator[Finding]:
    """Look for a lost 3D fix (critical), fewer than 6 satellites or an HDOP above 2 (warnings) in flight.

    A vehicle that never has a fix in flight flies without satellites: indoors, or under water.
    """
    fix = flight.flying_signal("gps_fix")
    if fix is not None and not (fix.values >= _FIX_3D).any():
        return
    if fix is not None and (fix.values < _FIX_3D).any():
        lost = float(fix.times[fix.values < _FIX_3D][0])
        text = "The receiver of satellite navigation lost its 3D fix while the vehicle was in the air."
        share = float((fix.values < _FIX_3D).mean())
        numbers = {"share_without_fix": share}
        yield Finding("gps_quality", Severity.CRITICAL, "GPS fix lost in flight", text, lost, numbers)
    satellites = flight.flying_signal("satellites")
    if satellites is not None and satellites.values.min() < _FEW_SATELLITES:
        fewest = float(satellites.values.min())
        text = f"At the worst moment {fewest:.0f} satellites were used; {_FEW_SATELLITES} or more are usual."
        time = float(satellites.times[satellites.values.argmin()])
        title = f"only {fewest:.0f} satellites"
        yield Finding("gps_quality", Severity.WARNING, title, text, time, {"satellites": fewest})
    hdop = flight.flying_signal("hdop")
    if hdop is not None and float(np.percentile(hdop.values, 95)) > _POOR_HDOP:
        level = float(np.percentile(hdop.values, 95))
        text = f"For 5 % of the flight the HDOP was at least {level:.1f}; below {_POOR_HDOP:.0f} is usual."
        time = float(hdop.times[hdop.values.argmax()])
        yield Finding("gps_quality", Severity.WARNING, f"HDOP {level:.1f}", text, time, {"hdop": level})


def gps_glitch(flight: Flight) -> Iterator[Finding]:
    """Look for jumps of the position that need more than 100 m/s."""
    track = flight.track
    if track is None or len(track) < 2:
        return
    moved = distances(track.latitudes[:-1], track.longitudes[:-1], track.latitudes[1:], track.longitudes[1:])
    allowed = _MAX_SPEED * np.clip(np.diff(track.times), 0, None) + _POSITION_NOISE
    jumps = np.flatnonzero(moved > allowed)
    jumps = jumps[flight.is_flying(track.times[jumps + 1] - flight.start)]
    if not len(jumps):
        return
    worst = jumps[moved[jumps].argmax()]
    farthest = float(moved[worst])
    yield Finding(
        "gps_glitch",
        Severity.CRITICAL,
        f"position jumped by {farthest:.0f} m",
        f"The position ({track.source}) jumped {len(jumps)} times by more than the vehicle can fly, at most "
        f"by {farthest:.0f} m: a glitch or spoofing of satellite navigation, or a reset of the estimator.",
        float(track.times[worst + 1] - flight.start),
        {"jump_m": farthest, "jumps": float(len(jumps))},
    )


def estimator(flight: Flight) -> Iterator[Finding]:
    """Look for test ratios of the estimator above 0.8 for a second (warning), or 1 (critical), in flight."""
    for name, word in (("compass", "compass"), ("velocity", "velocity"), ("position", "position")):
        signal = flight.flying_signal(f"{name}_variance")
        if signal is None:
            continue
        ratio = _lasting(signal.times, signal.values)
        if ratio < _HIGH_RATIO:
            continue
        yield Finding(
            "estimator",
            Severity.CRITICAL if ratio >= _REJECTED else Severity.WARNING,
            f"{word} disagrees with the estimate: ratio {ratio:.2f}",
            f"The test ratio of the {word} ({signal.source}) was at least {ratio:.2f} for a second. From "
            f"{_HIGH_RATIO} on ArduPilot's EKF failsafe acts, from 1 on the measurement is rejected. "
            + (
                "Look for magnetic interference."
                if name == "compass"
                else "Look at the GPS and at vibration."
            ),
            float(signal.times[signal.values.argmax()]),
            {"ratio": ratio, "max_ratio": float(signal.values.max())},
        )


def estimator_resets(flight: Flight) -> Iterator[Finding]:
    """Look for resets of the horizontal position estimate while armed."""
    steps = flight.armed_steps("position_resets")
    resets = None if steps is None else steps.during(steps.values != 0)
    if resets is not None and len(resets):
        noun = "reset" if len(resets) == 1 else "resets"
        text = f"The estimator reset its horizontal position while armed: {len(resets)} {noun}."
        time = float(resets.times[0])
        title = f"{len(resets)} {noun} of the position estimate"
        numbers = {"resets": float(len(resets))}
        yield Finding("estimator_resets", Severity.WARNING, title, text, time, numbers)


def _lasting(
    times: np.ndarray[tuple[int], np.dtype[np.float64]], values: np.ndarray[tuple[int], np.dtype[np.float64]]
) -> float:
    """Return the highest value that a signal kept for `_RATIO_TIME`."""
    highest = 0.0
    ends = np.searchsorted(times, times + _RATIO_TIME, side="right")
    for first, end in enumerate(ends.tolist()):
        if end < len(times) and values[first] > highest:
            highest = max(highest, float(values[first : end + 1].min()))
    return highest


RULES: Final = (
    Rule("gps_quality", str(gps_quality.__doc__), gps_quality),
    Rule("gps_glitch", str(gps_glitch.__doc__), gps_glitch),
    Rule("estimator", str(estimator.__doc__), estimator),
    Rule("estimator_resets", str(estimator_resets.__doc__), estimator_resets),
)
