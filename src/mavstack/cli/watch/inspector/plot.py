"""A plot of several series with braille dots, as lines of text.

Series with the same unit share a scale; series with another unit have one of their own, which the legend
tells. A column of dots shows the lowest and the highest value that fall into it, so that no peak is lost. A
gap means that no packet came.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from rich.text import Text

from mavstack.cli.common.field_values import UNKNOWN

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from mavstack.cli.watch.inspector.field_series import Point

#: Colours of the series, which people with any colour vision can distinguish.
COLOURS: Final = (
    "bright_yellow",
    "bright_cyan",
    "bright_magenta",
    "bright_green",
    "bright_blue",
    "bright_red",
)
#: Minimum length of a gap without points: in seconds, and as a multiple of the mean interval of the points.
_MIN_GAP: Final = 2.0
_GAP_INTERVALS: Final = 5
#: Width of the longest label, such as -1.235e-05, and of the axis.
_AXIS_WIDTH: Final = 11
_DOT_COLUMNS: Final = 2
_DOT_ROWS: Final = 4
_BRAILLE: Final = 0x2800
#: Bit of a dot by its row and column in a braille character.
_DOTS: Final = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))


@dataclass(frozen=True, slots=True)
class PlotSeries:
    """One series of a plot: its points, and the time at its right edge."""

    title: str
    unit: str
    colour: str
    points: Sequence[Point]
    end: float


class Scale(NamedTuple):
    """The lowest and the highest value of the series with one unit."""

    low: float
    high: float

    def share(self, value: float) -> float:
        """Return the height of a value, 0 to 1."""
        return (value - self.low) / (self.high - self.low)


class _Column(NamedTuple):
    """The values that fall into one column of dots."""

    first: float
    low: float
    high: float
    last: float
    begin: float
    end: float


def plot_lines(series: Sequence[PlotSeries], width: int, height: int, seconds: float) -> list[Text]:
    """Return a legend, the plot and its time axis, fitted to a width and a height.

    Args:
        series: The series; a later one is drawn over the ones before.
        width: Columns of text.
        height: Lines of text.
        seconds: Seconds from the left to the right edge.
    """
    scales = _scales(series)
    legend = [_legend(each, scales) for each in series][: max(height - 4, 1)]
    columns, rows = width - _AXIS_WIDTH, height - len(legend) - 1
    if columns < 8 or rows < 2:
        return [_fitted(line, width) for line in legend[:height]]
    canvas = _Canvas(columns, rows)
    for each in series:
        _draw(canvas, each, scales[each.unit], seconds)
    labels = [Text(f"{label:>{_AXIS_WIDTH - 1}}│", "dim") for label in _axis_labels(series, scales, rows)]
    body = [Text.assemble(label, line) for label, line in zip(labels, canvas.lines(), strict=True)]
    return [_fitted(line, width) for line in (*legend, *body, _time_axis(columns, seconds))]


def value_text(value: float) -> str:
    """Return a number with four or more significant digits, for an axis or a legend."""
    return f"{value:.0f}" if abs(value) >= 10_000 else f"{value:.4g}"


def _scales(series: Sequence[PlotSeries]) -> dict[str, Scale]:
    values: dict[str, list[float]] = {each.unit: [] for each in series}
    for each in series:
        values[each.unit] += [point.value for point in each.points if point.value is not None]
    return {unit: _scale(known) for unit, known in values.items()}


def _scale(values: Sequence[float]) -> Scale:
    low, high = min(values, default=0.0), max(values, default=0.0)
    margin = max(abs(low) * 1e-6, 0.5)
    return Scale(low, high) if high > low else Scale(low - margin, high + margin)


def _legend(series: PlotSeries, scales: Mapping[str, Scale]) -> Text:
    known = [point.value for point in series.points if point.value is not None]
    line = Text().append("━━ ", series.colour).append(series.title)
    line.append(f"  {value_text(known[-1])}{series.unit}" if known else f"  {UNKNOWN}", "bold")
    if known:
        line.append(f"  {value_text(min(known))} … {value_text(max(known))}", "dim")
    scale = scales[series.unit]
    if len(scales) > 1:
        line.append(f"  scale {value_text(scale.low)} … {value_text(scale.high)}", "dim")
    return line


def _axis_labels(series: Sequence[PlotSeries], scales: Mapping[str, Scale], rows: int) -> list[str]:
    """Return the labels of the vertical axis: the scale, if there is only one."""
    labels = [""] * rows
    if len(scales) == 1:
        (scale,) = scales.values()
        labels[0], labels[-1] = value_text(scale.high), value_text(scale.low)
        if rows >= 5:
            labels[rows // 2] = series[0].unit.strip()
    return labels


def _time_axis(columns: int, seconds: float) -> Text:
    begin = f"-{seconds:g} s "
    axis = begin.ljust(max(columns - 4, len(begin)), "─")
    return Text(f"{'└':>{_AXIS_WIDTH}}{axis} now", "dim")


def _fitted(line: Text, width: int) -> Text:
    line.no_wrap = True
    line.truncate(width, overflow="ellipsis")
    return line


class _Canvas:
    """A grid of braille dots with a colour for each character."""

    def __init__(self, columns: int, rows: int) -> None:
        self.width, self.height = columns * _DOT_COLUMNS, rows * _DOT_ROWS
        self._bits = [[0] * columns for _ in range(rows)]
        self._colours = [[""] * columns for _ in range(rows)]

    def column(self, x: int, low: int, high: int, colour: str) -> None:
        """Set the dots of a column from a height to another, 0 at the bottom."""
        for y in range(low, high + 1):
            row, column = (self.height - 1 - y) // _DOT_ROWS, x // _DOT_COLUMNS
            self._bits[row][column] |= _DOTS[(self.height - 1 - y) % _DOT_ROWS][x % _DOT_COLUMNS]
            self._colours[row][column] = colour

    def line(self, begin: tuple[int, int], end: tuple[int, int], colour: str) -> None:
        """Connect two dots."""
        (x0, y0), (x1, y1) = begin, end
        last = y0
        for x in range(x0 + 1, x1 + 1):
            y = y0 + round((y1 - y0) * (x - x0) / (x1 - x0))
            self.column(x, min(last, y), max(last, y), colour)
            last = y

    def lines(self) -> Iterator[Text]:
        """Yield the rows, top row first."""
        for bits, colours in zip(self._bits, self._colours, strict=True):
            line = Text()
            for dots, colour in zip(bits, colours, strict=True):
                line.append(chr(_BRAILLE + dots) if dots else " ", colour or None)
            yield line


def _draw(canvas: _Canvas, series: PlotSeries, scale: Scale, seconds: float) -> None:
    def height(value: float) -> int:
        return round(scale.share(value) * (canvas.height - 1))

    gap, colour = _gap(series.points), series.colour
    previous: tuple[int, _Column] | None = None
    for x, column in _columns(series, canvas.width, seconds).items():
        if previous is not None and column.begin - previous[1].end <= gap:
            canvas.line((previous[0], height(previous[1].last)), (x, height(column.first)), colour)
        canvas.column(x, height(column.low), height(column.high), colour)
        previous = x, column


def _columns(series: PlotSeries, width: int, seconds: float) -> dict[int, _Column]:
    start = series.end - seconds
    columns: dict[int, _Column] = {}
    for time, value in series.points:
        if value is None:
            continue
        x = min(max(int((time - start) / seconds * width), 0), width - 1)
        known = columns.get(x)
        if known is None:
            columns[x] = _Column(value, value, value, value, time, time)
        else:
            low, high = min(known.low, value), max(known.high, value)
            columns[x] = known._replace(low=low, high=high, last=value, end=time)
    return columns


def _gap(points: Sequence[Point]) -> float:
    """Return the seconds without a point that are drawn as a gap."""
    if len(points) < 2:
        return _MIN_GAP
    interval = (points[-1].time - points[0].time) / (len(points) - 1)
    return max(_MIN_GAP, _GAP_INTERVALS * interval)
