"""The data of an interactive report: charts, track, events and fields, as JSON within the page."""

from __future__ import annotations

import json
from base64 import b64encode
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.errors import LogError
from mavstack.logs.report.charts import TIME_AXIS, envelope, track_places

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from mavstack.logs.analysis import Finding, Flight
    from mavstack.logs.log import Log
    from mavstack.logs.report.charts import Chart

#: Points of a chart: two for each pixel, so that an enlarged part still has enough points.
_CHART_COLUMNS: Final = 2000
_MAX_EVENTS: Final = 2000
#: Maximum number of values of all fields together, and limits for the rows of one table.
_MAX_VALUES: Final = 1_500_000
_MIN_ROWS, _MAX_ROWS = 100, 2000


def page_data(
    log: Log, flights: Sequence[tuple[Flight, Sequence[Finding]]], charts: Sequence[tuple[int, Chart]]
) -> str:
    """Return the data of a page as JSON that can be within a script element.

    Args:
        log: The log.
        flights: The flights with their findings.
        charts: The charts, in their order in the page, with the number of their flight.
    """
    data = {
        "span": [0.0, log.duration],
        "vehicles": [_vehicle(number, *item) for number, item in enumerate(flights)],
        "charts": [_chart(vehicle, chart) for vehicle, chart in charts],
        "tables": _tables(log),
    }
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")


def is_over_time(chart: Chart) -> bool:
    """Return whether the horizontal axis of a chart is the time."""
    return chart.axis == TIME_AXIS


def _packed(values: NDArray[Any]) -> str:
    with np.errstate(over="ignore"):
        return b64encode(np.asarray(values).astype("<f4").tobytes()).decode()


def _vehicle(number: int, flight: Flight, findings: Sequence[Finding]) -> dict[str, Any]:
    events: list[tuple[float, str, str]] = [
        (finding.time, "finding", finding.title) for finding in findings if finding.time is not None
    ]
    events += [(start, "state", "armed") for start, _ in flight.armed_spans]
    events += [(end, "state", "disarmed") for _, end in flight.armed_spans]
    events += [(time, "text", text.text) for time, text in flight.texts if np.isfinite(time)]
    events += [
        (time, "parameter", f"{change.name} = {change.value:g}")
        for time, change in flight.parameter_changes
        if np.isfinite(time)
    ]
    modes = [[round(span.start, 3), round(span.end, 3), span.value] for span in flight.mode_spans]
    return {
        "number": number,
        "modes": modes[:_MAX_EVENTS],
        "events": sorted((round(float(time), 3), kind, text) for time, kind, text in events)[:_MAX_EVENTS],
        "track": _track(flight),
    }


def _track(flight: Flight) -> dict[str, str] | None:
    if flight.track is None or not len(flight.track):
        return None
    thin, xs, ys = track_places(flight.track)
    return {"t": _packed(thin.times - flight.start), "x": _packed(xs), "y": _packed(ys)}


def _chart(vehicle: int, chart: Chart) -> dict[str, Any]:
    lines = [envelope(line.xs, line.ys, _CHART_COLUMNS) for line in chart.drawn_lines]
    return {"vehicle": vehicle, "lines": [{"x": _packed(xs), "y": _packed(ys)} for xs, ys in lines]}


def _tables(log: Log) -> list[dict[str, Any]]:
    """Return the fields of all tables that vary, with fewer rows if there are many."""
    fields = sum(len(log.schema(name)) for name in log)
    rows = int(np.clip(_MAX_VALUES // max(fields, 1), _MIN_ROWS, _MAX_ROWS))
    return [table for name in sorted(log) if (table := _table(log, name, rows)) is not None]


def _table(log: Log, name: str, rows: int) -> dict[str, Any] | None:
    table = log[name]
    try:
        times = log.seconds_from_start(name, table)
    except LogError:
        return None
    known = np.flatnonzero(np.isfinite(times))
    order = known[np.argsort(times[known], kind="stable")]
    if len(order) > rows:
        order = order[np.unique(np.linspace(0, len(order) - 1, rows).round().astype(np.intp))]
    part = table[order]
    found = list(_fields(part))
    return {"name": name, "vehicle": 0, "t": _packed(times[order]), "fields": found} if found else None


def _fields(part: Any) -> Iterator[dict[str, str]]:  # noqa: ANN401 (a table; its slices have no type)
    for item in part.schema:
        if item.name.startswith("_") or not item.is_number:
            continue
        values = np.asarray(part.scaled(item.name)).astype(np.float64)
        known = values[np.isfinite(values)]
        if len(known) > 1 and known.min() < known.max():
            yield {"name": item.name, "unit": item.unit, "y": _packed(values)}
