"""Line charts as SVG: signals over time, spectra, and tracks, drawn for the style sheet of the page.

A chart has at most two points for each of its columns of pixels, the lowest and the highest value, so that
spikes stay visible and a long flight costs no more than a short one. Colours come from the style sheet, which
has a light and a dark theme.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from html import escape
from math import ceil, floor, log10
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from mavstack.geodesy import METRES_PER_DEGREE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from mavstack.logs.tracks import Track

_WIDTH: Final = 860
_HEIGHT: Final = 190
_LEFT, _RIGHT, _TOP, _BOTTOM = 52, 12, 12, 24
_TITLE: Final = 24
_MAP_SIZE: Final = 420
_COLOURS: Final = 6
#: CSS classes of the numbers at an axis: every other number is minor, and hidden on phones.
_MINOR: Final = ("", " minor")
#: Unit of the time axis of a chart.
TIME_AXIS: Final = "s"
#: Maximum value; a larger one is damaged and drawn at the edge, so that the range does not overflow.
_MAX_VALUE: Final = 1e30


@dataclass(frozen=True, eq=False)
class Line:
    """A line of a chart."""

    label: str
    xs: NDArray[np.float64]
    ys: NDArray[np.float64]


class Band(NamedTuple):
    """A stretch of the horizontal axis with a name, such as a flight mode."""

    start: float
    end: float
    label: str


@dataclass(frozen=True)
class Chart:
    """A chart with one or several lines.

    Attributes:
        title: Title.
        unit: Unit of the vertical axis.
        lines: The lines; a chart without points is not drawn.
        bands: Stretches in the background.
        marks: Positions of findings on the horizontal axis.
        axis: Unit of the horizontal axis.
        span: Stretch that the horizontal axis shows at least; None: that of the lines.
    """

    title: str
    unit: str
    lines: Sequence[Line]
    bands: Sequence[Band] = ()
    marks: Sequence[float] = ()
    axis: str = TIME_AXIS
    span: tuple[float, float] | None = None

    @property
    def drawn_lines(self) -> list[Line]:
        """The lines that have points."""
        return [line for line in self.lines if len(line.xs)]

    @property
    def extent(self) -> tuple[float, float]:
        """Beginning and end of the horizontal axis, of a chart with points."""
        ends = [*(self.span or ()), *(float(line.xs[end]) for line in self.drawn_lines for end in (0, -1))]
        return min(ends), max(ends)


def aligned(charts: Iterable[Chart]) -> list[Chart]:
    """Return charts with one axis of time for all of them; others, such as spectra, stay as they are.

    Args:
        charts: The charts.
    """
    drawn = [chart for chart in charts if chart.drawn_lines]
    ends = [end for chart in drawn if chart.axis == TIME_AXIS for end in chart.extent]
    return [
        replace(chart, span=(min(ends), max(ends))) if chart.axis == TIME_AXIS else chart for chart in drawn
    ]


def draw(chart: Chart, number: int | None = None) -> str:
    """Return a chart as a figure with an SVG; empty if it has no points.

    Args:
        chart: The chart.
        number: Number of the chart in the data of the page, for its script; None for none.
    """
    content = _content(chart)
    if not content:
        return ""
    mark = "" if number is None else f' data-chart="{number}"'
    lines = chart.drawn_lines
    unit = f" <small>{escape(chart.unit)}</small>" if chart.unit else ""
    named = len(lines) == 1 and lines[0].label.lower() == chart.title.lower()
    legend = (
        ""
        if named
        else "".join(
            f'<span class="key c{number % _COLOURS}">{escape(line.label)}</span>'
            for number, line in enumerate(lines)
        )
    )
    return (
        f"<figure{mark}>"
        f"<figcaption>{escape(chart.title)}{unit}{legend}</figcaption>"
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{escape(chart.title)}">'
        f"{content}</svg></figure>"
    )


def _content(chart: Chart) -> str:
    """Return the elements of a chart; empty if it has no points."""
    lines = chart.drawn_lines
    if not lines:
        return ""
    left, right = chart.extent
    low, high = min(float(line.ys.min()) for line in lines), max(float(line.ys.max()) for line in lines)
    low, high = max(low, -_MAX_VALUE), min(high, _MAX_VALUE)
    scale = _Scale(left, right if right > left else left + 1, *_padded(low, high))
    parts = [_bands(chart.bands, scale), _grid(scale, chart.axis), *_marks(chart.marks, scale)]
    parts += [_polyline(line, scale, number % _COLOURS) for number, line in enumerate(lines)]
    return "".join(parts)


def svg_document(charts: Sequence[Chart], style: str) -> str:
    """Return charts below each other as one SVG file.

    Args:
        charts: The charts.
        style: The style sheet.
    """
    drawn = [(chart, content) for chart in charts if (content := _content(chart))]
    parts = []
    for number, (chart, content) in enumerate(drawn):
        unit = f" [{chart.unit}]" if chart.unit else ""
        title = f"{chart.title}{unit}: {', '.join(line.label for line in chart.lines)}"
        parts.append(
            f'<g transform="translate(0 {number * (_HEIGHT + _TITLE)})">'
            f'<text class="title" x="{_LEFT}" y="16">{escape(title)}</text>'
            f'<g transform="translate(0 {_TITLE})">{content}</g></g>'
        )
    height = max(len(drawn), 1) * (_HEIGHT + _TITLE)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" width="{_WIDTH}">'
        f"<style>{escape(style)}</style>{''.join(parts)}</svg>\n"
    )


def track_places(track: Track) -> tuple[Track, NDArray[np.float64], NDArray[np.float64]]:
    """Return the points of a track that its map shows, and their places on the map."""
    thin = track.thinned(4000)
    north = np.cos(np.radians(float(np.median(thin.latitudes))))
    xs, ys = thin.longitudes * north, -thin.latitudes
    span = max(float(np.ptp(xs)), float(np.ptp(ys)), 10 / METRES_PER_DEGREE) * 1.15
    places = [((column - (column.max() + column.min()) / 2) / span + 0.5) * _MAP_SIZE for column in (xs, ys)]
    return thin, places[0], places[1]


def draw_track(track: Track, marks: Sequence[tuple[float, float]] = (), number: int = 0) -> str:
    """Return a track as an SVG map, north up, with a scale; `marks` are latitudes and longitudes.

    Args:
        track: The track.
        marks: Positions to mark.
        number: Number of the vehicle in the data of the page.
    """
    thin = track.thinned(4000)
    north = np.cos(np.radians(float(np.median(thin.latitudes))))
    xs, ys = thin.longitudes * north, -thin.latitudes
    span = max(float(np.ptp(xs)), float(np.ptp(ys)), 10 / METRES_PER_DEGREE) * 1.15
    middle_x, middle_y = (xs.max() + xs.min()) / 2, (ys.max() + ys.min()) / 2

    def place(x: float, y: float) -> tuple[float, float]:
        return ((x - middle_x) / span + 0.5) * _MAP_SIZE, ((y - middle_y) / span + 0.5) * _MAP_SIZE

    points = " ".join(
        "{:.1f},{:.1f}".format(*place(x, y)) for x, y in zip(xs.tolist(), ys.tolist(), strict=True)
    )
    start, end = place(float(xs[0]), float(ys[0])), place(float(xs[-1]), float(ys[-1]))
    placed = [place(longitude * north, -latitude) for latitude, longitude in marks]
    found = "".join(f'<circle class="mark" cx="{x:.1f}" cy="{y:.1f}" r="6"/>' for x, y in placed)
    length = _round_down(span * METRES_PER_DEGREE / 3)
    pixels = length / (span * METRES_PER_DEGREE) * _MAP_SIZE
    return (
        f'<svg class="map" data-vehicle="{number}" viewBox="0 0 {_MAP_SIZE} {_MAP_SIZE}" role="img" '
        'aria-label="track">'
        f'<polyline class="line c0" points="{points}"/>{found}'
        f'<circle class="start" cx="{start[0]:.1f}" cy="{start[1]:.1f}" r="5"/>'
        f'<circle class="end" cx="{end[0]:.1f}" cy="{end[1]:.1f}" r="5"/>'
        f'<path class="axis" d="M12 {_MAP_SIZE - 14}h{pixels:.1f}"/>'
        f'<text x="12" y="{_MAP_SIZE - 20}">{_length_text(length)}</text></svg>'
    )


class _Scale(NamedTuple):
    """The range of values that a chart shows."""

    left: float
    right: float
    low: float
    high: float

    def x(self, value: float) -> float:
        share = (value - self.left) / (self.right - self.left)
        return _LEFT + min(max(share, 0), 1) * (_WIDTH - _LEFT - _RIGHT)

    def y(self, value: float) -> float:
        value = min(max(value, self.low), self.high)
        return _HEIGHT - _BOTTOM - (value - self.low) / (self.high - self.low) * (_HEIGHT - _TOP - _BOTTOM)

    def xs(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        shares = (values - self.left) / (self.right - self.left)
        return _LEFT + np.clip(shares, 0, 1) * (_WIDTH - _LEFT - _RIGHT)

    def ys(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        shares = (np.clip(values, self.low, self.high) - self.low) / (self.high - self.low)
        return _HEIGHT - _BOTTOM - shares * (_HEIGHT - _TOP - _BOTTOM)


def _padded(low: float, high: float) -> tuple[float, float]:
    """Return a range with some room, also around a constant value."""
    room = (high - low) * 0.05 or abs(high) * 0.1 or 1.0
    return low - room, high + room


def _polyline(line: Line, scale: _Scale, colour: int) -> str:
    xs, ys = envelope(line.xs, line.ys, _WIDTH - _LEFT - _RIGHT)
    columns = (scale.xs(xs).tolist(), scale.ys(ys).tolist())
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(*columns, strict=True))
    return f'<polyline class="line c{colour}" points="{points}"/>'


def envelope(
    xs: NDArray[np.float64], ys: NDArray[np.float64], columns: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lowest and the highest point in each of `columns` parts of a line, in their order."""
    if len(xs) <= 2 * columns:
        return xs, ys
    edges = np.unique(np.linspace(0, len(xs), columns + 1).astype(np.intp))[:-1]
    kept: list[int] = []
    for first, last in zip(edges.tolist(), [*edges[1:].tolist(), len(xs)], strict=True):
        part = ys[first:last]
        kept += sorted({first + int(part.argmin()), first + int(part.argmax())})
    return xs[kept], ys[kept]


def _grid(scale: _Scale, axis: str) -> str:
    parts = []
    for number, value in enumerate(_ticks(scale.low, scale.high, 4)):
        y, minor = scale.y(value), _MINOR[number % 2]
        parts.append(f'<path class="grid" d="M{_LEFT} {y:.1f}H{_WIDTH - _RIGHT}"/>')
        parts.append(f'<text class="y{minor}" x="{_LEFT - 6}" y="{y + 4:.1f}">{value:g}</text>')
    for number, value in enumerate(_ticks(scale.left, scale.right, 8)):
        x, minor = scale.x(value), _MINOR[number % 2]
        parts.append(f'<text class="x{minor}" x="{x:.1f}" y="{_HEIGHT - 6}">{value:g} {axis}</text>')
    return "".join(parts)


def _ticks(low: float, high: float, count: int) -> list[float]:
    step = _round_down((high - low) / count) or 1.0
    first = ceil(low / step)
    return [round(number * step, 10) for number in range(first, floor(high / step) + 1)]


def _round_down(value: float) -> float:
    """Return the next lower number of the series 1, 2, 5, 10 …."""
    if value <= 0:
        return 0.0
    power = 10.0 ** floor(log10(value))
    return next(step * power for step in (5, 2, 1) if step * power <= value * (1 + 1e-9))


def _length_text(metres: float) -> str:
    return f"{metres / 1000:g} km" if metres >= 1000 else f"{metres:g} m"


def _bands(bands: Sequence[Band], scale: _Scale) -> str:
    parts = []
    pixel = (scale.right - scale.left) / (_WIDTH - _LEFT - _RIGHT)
    for number, band in enumerate(bands):
        if band.end - band.start < pixel:
            continue  # too narrow to see; a flight may have thousands of these
        x, end = scale.x(band.start), scale.x(band.end)
        if end - x < 1:
            continue
        parts.append(
            f'<rect class="band b{number % 2}" x="{x:.1f}" y="{_TOP}" width="{end - x:.1f}" '
            f'height="{_HEIGHT - _TOP - _BOTTOM}"><title>{escape(band.label)}</title></rect>'
        )
        if end - x > 7 * len(band.label) + 4:
            parts.append(f'<text class="band" x="{x + 3:.1f}" y="{_TOP + 10}">{escape(band.label)}</text>')
    return "".join(parts)


def _marks(marks: Sequence[float], scale: _Scale) -> list[str]:
    return [
        f'<path class="mark" d="M{scale.x(mark):.1f} {_TOP}V{_HEIGHT - _BOTTOM}"/>'
        for mark in marks
        if scale.left <= mark <= scale.right
    ]
