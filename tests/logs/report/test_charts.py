"""Charts as SVG."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.logs.report.charts import Band, Chart, Line, aligned, draw, envelope, svg_document
from mavstack.logs.report.page import page_file
from mavstack.logs.report.png import png_of

finite = st.floats(-1e9, 1e9)


@given(st.lists(finite, min_size=1, max_size=3000), st.integers(1, 40))
def test_the_envelope_keeps_the_extremes(values, columns):
    ys = np.array(values)
    xs, kept = envelope(np.arange(len(ys), dtype=float), ys, columns)
    assert len(kept) <= max(2 * columns, len(ys) if len(ys) <= 2 * columns else 0)
    assert (kept.min(), kept.max()) == (ys.min(), ys.max())
    assert (np.diff(xs) > 0).all()


@given(st.lists(finite, min_size=1, max_size=50))
def test_every_point_is_inside_of_the_chart(values):
    xs = np.arange(len(values), dtype=float)
    chart = Chart("A & B", "m/s", [Line("<a>", xs, np.array(values))], [Band(0, 1, "MODE")], [0.5])
    root = ElementTree.fromstring(draw(chart))
    svg = next(root.iter("svg"))
    _, _, width, height = map(float, svg.get("viewBox", "").split())
    (line,) = svg.iter("polyline")
    for point in line.get("points", "").split():
        x, y = map(float, point.split(","))
        assert 0 <= x <= width
        assert 0 <= y <= height


def test_a_chart_without_points_is_not_drawn():
    assert draw(Chart("empty", "", [Line("a", np.empty(0), np.empty(0))])) == ""


def test_the_axis_shows_all_points_and_the_span():
    line = Line("x", np.array([2.0, 5.0]), np.array([1.0, 2.0]))
    assert Chart("x", "", [line]).extent == (2.0, 5.0)
    assert Chart("x", "", [line], span=(0.0, 9.0)).extent == (0.0, 9.0)
    assert Chart("x", "", [line], span=(3.0, 4.0)).extent == (2.0, 5.0), "no point is outside"


def test_charts_over_time_have_one_axis():
    def chart(left, right, axis="s"):
        return Chart("x", "", [Line("x", np.array([left, right]), np.array([1.0, 2.0]))], axis=axis)

    empty = Chart("empty", "", [Line("x", np.empty(0), np.empty(0))])
    found = aligned([chart(2.0, 5.0), chart(0.0, 200.0, "Hz"), empty, chart(1.0, 4.0)])
    assert [each.extent for each in found] == [(1.0, 5.0), (0.0, 200.0), (1.0, 5.0)]


@pytest.fixture
def charts():
    xs = np.linspace(0, 10, 100)
    return [
        Chart("one", "m", [Line("sin", xs, np.sin(xs))], [Band(0, 5, "A")]),
        Chart("two", "", [Line("x", xs, xs)]),
    ]


def test_an_svg_file_has_all_charts(charts):
    root = ElementTree.fromstring(svg_document(charts, page_file("page.css")))
    assert len(list(root.iter("{http://www.w3.org/2000/svg}polyline"))) == 2


def test_a_png_is_not_empty(charts):
    import io

    from matplotlib.image import imread

    picture = imread(io.BytesIO(png_of(charts)))
    assert picture.shape[1] == 1100
    coloured = (np.ptp(picture[:, :, :3], axis=2) > 0.3).sum()
    assert coloured > 500, "the lines are drawn in colour"


def test_values_at_the_ends_of_their_type_are_drawn():
    ys = np.array([-1e308, 0.0, 1e308])
    chart = draw(Chart("x", "", [Line("x", np.arange(3.0), ys)]))
    assert "nan" not in chart
    assert "inf" not in chart
