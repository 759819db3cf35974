"""The report of a log: facts and findings of each vehicle, with charts, as HTML and as values for JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from mavstack.logs.analysis import analyse, flights
from mavstack.logs.report.page import MARK, render_page

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.logs.analysis import Finding, Flight
    from mavstack.logs.log import Log


@dataclass(frozen=True, slots=True)
class Report:
    """The report of a log.

    Attributes:
        html: The page, which needs no other file and no network.
        data: The facts and findings as values that JSON can hold.
    """

    html: str
    data: dict[str, Any]


def make_report(log: Log) -> Report:
    """Make the report of a log.

    Args:
        log: The log, or a view of it.

    Returns:
        The report.

    Raises:
        LogError: The log cannot be read.
    """
    found = [(flight, analyse(flight), flight_facts(flight)) for flight in flights(log)]
    data = {
        "kind": MARK,
        "file": log.path.name,
        "format": log.format,
        "size": log.size,
        "start": None if log.start is None else f"{log.start}Z",
        "duration_s": round(log.duration, 3),
        "time_base": log.time_base.describe(),
        "info": dict(log.info),
        "skipped": log.skipped.to_dict(),
        "vehicles": [_vehicle_data(flight, findings, facts) for flight, findings, facts in found],
    }
    return Report(render_page(log, found), data)


def flight_facts(flight: Flight) -> dict[str, float]:
    """Return the figures of a flight: times in s, distances in m, speeds in m/s.

    They are those of the time while the vehicle was armed, of the whole log if the log does not hold that.

    Args:
        flight: The flight.
    """
    facts: dict[str, float] = {
        "armed_s": sum(end - start for start, end in flight.armed_spans),
        "takeoffs": float(flight.takeoffs),
    }
    read = flight.armed_signal
    if not flight.states.armed.is_known:
        facts, read = {}, flight.signal
    if flight.track is not None and len(flight.track) > 1:
        facts["distance_m"] = flight.track.distance
    for name, key, choose in (
        ("altitude", "max_altitude_m", np.max),
        ("ground_speed", "max_ground_speed_m_s", np.max),
        ("climb_rate", "max_climb_rate_m_s", np.max),
        ("voltage", "min_voltage_v", np.min),
        ("current", "max_current_a", np.max),
    ):
        signal = read(name)
        if signal is not None and len(signal):
            facts[key] = float(choose(signal.values))
    if facts.get("max_current_a", 0.0) < 0:
        # A negative maximum means that the sensor is not calibrated or not connected.
        del facts["max_current_a"]
    current = read("current")
    if current is not None and len(current) > 1:
        # Limit each step to 5 s, so that a gap in the log does not count as consumption.
        steps = np.clip(np.diff(current.times), 0, 5)
        used = float((current.values[:-1] * steps).sum() / 3.6)
        # A sensor that is not connected may measure a negative current.
        facts |= {"used_mah": used} if used >= 0 else {}
    return {name: round(value, 3) for name, value in facts.items()}


def _vehicle_data(flight: Flight, findings: Sequence[Finding], facts: dict[str, float]) -> dict[str, Any]:
    return {
        "system": flight.system,
        "vehicle_type": flight.vehicle_type,
        "facts": facts,
        "findings": [finding.to_dict() for finding in findings],
        "modes": [
            {"mode": span.value, "start_s": round(span.start, 3), "end_s": round(span.end, 3)}
            for span in flight.mode_spans
        ],
        "knows_arming": flight.states.armed.is_known,
        "armed": [{"start_s": round(start, 3), "end_s": round(end, 3)} for start, end in flight.armed_spans],
    }
