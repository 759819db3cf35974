"""The HTML page of a report."""

from __future__ import annotations

from functools import cache
from html import escape
from importlib.resources import files
from itertools import chain
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import LogError
from mavstack.logs.report.charts import aligned, draw, draw_track
from mavstack.logs.report.page_data import is_over_time, page_data
from mavstack.logs.report.panels import PANELS, charts_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from mavstack.logs.analysis import Finding, Flight
    from mavstack.logs.log import Log
    from mavstack.logs.report.charts import Chart

#: Text near the beginning of each page, and of the file with its facts.
MARK: Final = "mavstack flight report"
_TITLES: Final = {
    "attitude": "Attitude",
    "altitude": "Altitude",
    "speed": "Speed",
    "power": "Power",
    "vibration": "Vibration",
    "estimator": "Estimator",
    "gps": "Satellite navigation",
    "outputs": "Motors and servos",
    "link": "Radio links",
    "processor": "Processor",
}
_FACTS: Final = {
    "armed_s": ("armed", "s"),
    "takeoffs": ("takeoffs", ""),
    "distance_m": ("distance", "m"),
    "max_altitude_m": ("highest above home", "m"),
    "max_ground_speed_m_s": ("fastest over ground", "m/s"),
    "max_climb_rate_m_s": ("fastest climb", "m/s"),
    "min_voltage_v": ("lowest voltage", "V"),
    "max_current_a": ("highest current", "A"),
    "used_mah": ("used", "mAh"),
}
#: Information about a log that is shown at the head of the page.
_SHOWN: Final = ("vehicle_type", "autopilot", "firmware", "firmware_version", "hardware")
_MAX_ROWS: Final = 500
#: A pause is a gap if it is longer than this many usual intervals of the message.
_GAP: Final = 5.0


def render_page(log: Log, found: Sequence[tuple[Flight, Sequence[Finding], Mapping[str, float]]]) -> str:
    """Return the page of a log.

    Args:
        log: The log.
        found: The flights with their findings and figures.
    """
    charts: list[tuple[int, Chart]] = []
    body = "".join(
        _vehicle(number, flight, findings, facts, len(found) > 1, charts)
        for number, (flight, findings, facts) in enumerate(found)
    )
    data = page_data(log, [(flight, findings) for flight, findings, _ in found], charts)
    damage = f'<p class="dim">Skipped: {escape(log.skipped.describe())}.</p>' if log.skipped else ""
    head = f'<h1>{escape(log.path.name)}</h1><p class="dim">{escape(_subtitle(log))}</p>'
    tools, fields = '<div id="tools"></div>', '<div id="fields"></div>'
    content = f"{head}{damage}{tools}{body}{fields}{_messages(log)}{_information(log)}"
    return _document(log.path.name, content, data)


def _subtitle(log: Log) -> str:
    parts = [log.format, f"{log.size / 1e6:.1f} MB", _duration(log.duration)]
    if log.start is not None:
        parts.insert(0, f"{str(log.start)[:19].replace('T', ' ')} UTC")
    parts += [log.info[name] for name in _SHOWN if name in log.info]
    return " · ".join(parts)


def _information(log: Log) -> str:
    """Return the table of what the log says about itself."""
    rows = "".join(
        f"<tr><td>{escape(name.replace('_', ' '))}</td><td>{escape(value)}</td></tr>"
        for name, value in log.info.items()
    )
    if not rows:
        return ""
    return f"<details><summary>Information ({len(log.info)})</summary><table>{rows}</table></details>"


def _duration(seconds: float) -> str:
    """Return a length of time, such as "12 s", "7 min 9 s" or "1 h 30 min"."""
    minutes, rest = divmod(round(seconds), 60)
    if minutes >= 60:
        return f"{minutes // 60} h {minutes % 60} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"


def _vehicle(
    number: int,
    flight: Flight,
    findings: Sequence[Finding],
    facts: Mapping[str, float],
    named: bool,
    numbered: list[tuple[int, Chart]],
) -> str:
    """Return the part of a vehicle; its charts over time are added to `numbered`."""
    parts = [f"<h2>Vehicle {flight.system}: {escape(flight.vehicle_type or 'unknown')}</h2>" if named else ""]
    parts += [_cards(facts), "<h2>Findings</h2>", *(_finding(finding) for finding in findings)]
    if not findings:
        parts.append("<p>The rules found nothing.</p>")
    if not flight.states.armed.is_known:
        parts.append(
            '<p class="dim">The log does not hold when the vehicle was armed: '
            "rules about the time in flight did not apply.</p>"
        )
    if flight.track is not None and len(flight.track):
        parts += ["<h2>Track</h2>", draw_track(flight.track, list(_places(flight, findings)), number)]
    marks = [finding.time for finding in findings if finding.time is not None]
    charts = {topic: list(charts_of(flight, topic, marks)) for topic in PANELS}
    drawn = {}
    for chart in aligned(chain.from_iterable(charts.values())):
        is_numbered = is_over_time(chart)
        drawn[chart.title] = draw(chart, len(numbered) if is_numbered else None)
        numbered += [(number, chart)] if is_numbered else []
    for topic, found in charts.items():
        if found:
            parts.append(f"<h2>{_TITLES[topic]}</h2>{''.join(drawn[chart.title] for chart in found)}")
    parts += [_timeline(flight), _changes(flight)]
    return "".join(parts)


def _cards(facts: Mapping[str, float]) -> str:
    cards = "".join(
        f'<div class="card"><b>{_duration(value) if unit == "s" else f"{value:,.4g} {unit}"}</b>'
        f"<span>{label}</span></div>"
        for name, (label, unit) in _FACTS.items()
        if (value := facts.get(name)) is not None
    )
    return f'<div class="cards">{cards}</div>'


def _finding(finding: Finding) -> str:
    when = "" if finding.time is None else f" <small>at {finding.time:.1f} s</small>"
    return (
        f'<div class="finding {finding.severity.name.lower()}"><b>{escape(finding.title)}{when}</b>'
        f"{escape(finding.text)}</div>"
    )


def _places(flight: Flight, findings: Sequence[Finding]) -> Iterator[tuple[float, float]]:
    """Yield the positions at which there are findings."""
    track = flight.track
    if track is None:
        return
    seconds = track.times - flight.start
    for finding in findings:
        if finding.time is not None and seconds[0] <= finding.time <= seconds[-1]:
            index = int(np.searchsorted(seconds, finding.time).clip(0, len(track) - 1))
            yield float(track.latitudes[index]), float(track.longitudes[index])


def _timeline(flight: Flight) -> str:
    rows = [(span.start, "mode", span.value) for span in flight.mode_spans]
    rows += [(start, "state", "armed") for start, _ in flight.armed_spans]
    rows += [(end, "state", "disarmed") for _, end in flight.armed_spans if end < flight.duration]
    rows += [(time, "text", text.text) for time, text in flight.texts if np.isfinite(time)]
    return _table("Modes and texts", ("time", "kind", "event"), sorted(rows, key=lambda row: row[0]))


def _changes(flight: Flight) -> str:
    rows = [
        (time, change.name, f"{'' if change.before is None else f'{change.before:g} -> '}{change.value:g}")
        for time, change in flight.parameter_changes
        if np.isfinite(time)
    ]
    return _table("Parameter changes", ("time", "parameter", "value"), rows)


def _table(title: str, head: Sequence[str], rows: Sequence[tuple[float, str, str]]) -> str:
    if not rows:
        return ""
    body = "".join(
        f'<tr><td class="n">{time:.1f} s</td><td>{escape(kind)}</td><td>{escape(text)}</td></tr>'
        for time, kind, text in rows[:_MAX_ROWS]
    )
    more = f'<p class="dim">{len(rows) - _MAX_ROWS} more.</p>' if len(rows) > _MAX_ROWS else ""
    heads = f'<th class="n">{head[0]}</th><th>{head[1]}</th><th>{head[2]}</th>'
    return (
        f"<details><summary>{title} ({len(rows)})</summary>"
        f"<table><tr>{heads}</tr>{body}</table>{more}</details>"
    )


def _messages(log: Log) -> str:
    rows = "".join(
        f'<tr><td>{escape(name)}</td><td class="n">{count:,}</td><td class="n">{_rate(log, count)}</td>'
        f'<td class="n">{_max_gap(log, name)}</td></tr>'
        for name, count in sorted(log.counts.items())
    )
    return (
        f'<details><summary>Messages ({len(log)})</summary><table><tr><th>message</th><th class="n">rows</th>'
        f'<th class="n">Hz</th><th class="n">longest gap</th></tr>{rows}</table></details>'
    )


def _rate(log: Log, count: int) -> str:
    return f"{count / log.duration:.3g}" if log.duration > 0 else "-"


def _max_gap(log: Log, name: str) -> str:
    """Return the longest gap of a message that is sent regularly, in seconds."""
    try:
        times = log.times(name)
    except LogError:
        return ""
    times = np.sort(times[np.isfinite(times)])
    if len(times) < 10:
        return ""
    steps = np.diff(times)
    max_gap, usual = float(steps.max()), float(np.median(steps))
    return f"{max_gap:.1f} s" if max_gap > max(_GAP * usual, 1.0) else ""


def plot_page(title: str, charts: Sequence[Chart]) -> str:
    """Return a page with charts.

    Args:
        title: Title of the page.
        charts: The charts.
    """
    return _document(title, f"<h1>{escape(title)}</h1>{''.join(map(draw, charts))}")


def _document(title: str, body: str, data: str = "") -> str:
    script = ""
    if data:
        code = page_file("page.js")
        script = f'<script type="application/json" id="flight-data">{data}</script><script>{code}</script>'
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        f'<meta name="generator" content="{MARK}">'
        f"<title>{escape(title)}</title><style>{page_file('page.css')}</style></head><body><main>{body}</main>{script}</body></html>\n"
    )


@cache
def page_file(name: str) -> str:
    """Return a file of the page: its style sheet or its script."""
    return (files(__package__) / name).read_text("utf-8")
