"""Plots as lines of text."""

from __future__ import annotations

import pytest

from mavstack.cli.watch.inspector.field_series import Point
from mavstack.cli.watch.inspector.plot import COLOURS, PlotSeries, plot_lines, value_text


def series(
    values, unit: str = "", step: float = 1.0, end: float | None = None, title: str = "field"
) -> PlotSeries:
    points = [Point(index * step, value) for index, value in enumerate(values)]
    return PlotSeries(title, unit, COLOURS[0], points, points[-1].time if points else 0.0)


def drawn(*all_series: PlotSeries, width: int = 60, height: int = 12, seconds: float = 10.0) -> list[str]:
    return [line.plain for line in plot_lines(all_series, width, height, seconds)]


def dots(lines: list[str]) -> list[str]:
    """Return the lines of the plot without axes, braille only."""
    return [line.split("│", 1)[1] for line in lines if "│" in line]


@pytest.mark.parametrize(("width", "height"), [(80, 24), (40, 6), (20, 3), (12, 2), (200, 60), (5, 1)])
@pytest.mark.parametrize("values", [[], [1.0], [None, None], [1.0, -5e9, 3.0], [0.0] * 100])
def test_a_plot_fits_its_size(width, height, values):
    lines = drawn(series(values), series(values, " m"), width=width, height=height)
    assert len(lines) <= height
    assert max(map(len, lines), default=0) <= width


def test_a_rising_line():
    lines = drawn(series(range(11)))
    body = dots(lines)
    columns = [next(row for row in range(len(body)) if body[row].ljust(60)[x] != " ") for x in range(48)]
    assert columns == sorted(columns, reverse=True)
    assert (columns[0], columns[-1]) == (len(body) - 1, 0)


def test_legend_scale_and_time():
    lines = drawn(series([1.5, 3.25, 2.0], " m/s", title="1/1 VFR_HUD.airspeed"))
    assert lines[0] == "━━ 1/1 VFR_HUD.airspeed  2 m/s  1.5 … 3.25"
    assert lines[1].startswith("      3.25│")
    assert lines[-2].startswith("       1.5│")
    assert "m/s│" in "".join(lines)
    assert lines[-1].endswith("─ now")
    assert "└-10 s" in lines[-1]


def test_long_numbers_fit_the_axis():
    lines = drawn(series([-1.235e-05, 0.001735]), width=40)
    assert lines[1].startswith("  0.001735│")
    assert lines[-2].startswith("-1.235e-05│")
    assert {len(line) for line in lines[1:]} == {40}


def test_fields_with_one_unit_share_a_scale_and_others_have_their_own():
    shared = drawn(series([0.0, 1.0], "°"), series([0.0, 100.0], "°"))
    assert shared[2].startswith("       100│")
    own = drawn(series([0.0, 1.0], "°"), series([0.0, 100.0], " m"))
    assert own[0].endswith("scale 0 … 1")
    assert own[1].endswith("scale 0 … 100")
    assert own[2].startswith("          │")


def test_a_gap_where_no_packet_came():
    values = [Point(t / 10, 1.0) for t in range(100) if not 30 <= t < 70]
    body = "".join(dots(drawn(PlotSeries("field", "", COLOURS[0], values, 10.0))))
    parts = body.split()
    assert len(parts) == 2


def test_no_peak_is_lost():
    values = [0.0] * 5000
    values[2500] = 7.0
    body = dots(drawn(series(values, step=0.002)))
    assert body[0].strip()


def test_an_unknown_value():
    assert drawn(series([None]))[0] == "━━ field  –"  # noqa: RUF001 (a dash)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1.23456, "1.235"), (-57.04, "-57.04"), (12345.6, "12346"), (1e9, f"{10**9}")],
)
def test_numbers(value, text):
    assert value_text(value) == text
