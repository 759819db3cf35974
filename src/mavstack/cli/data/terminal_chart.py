"""Charts on a terminal, drawn with Braille patterns: eight points in each cell.

Each line of a chart has a colour; a cell in which several lines meet has that of the last one.
"""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.cli.common.output import coloured

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.logs.report.charts import Chart

#: Bits of the Braille pattern of a cell, by row and column.
_BITS: Final = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
_BRAILLE: Final = 0x2800
_LABEL: Final = 10
_COLOURS: Final = ("cyan", "yellow", "magenta", "green", "blue", "red")


def chart_lines(chart: Chart, width: int, height: int = 8) -> Iterator[str]:
    """Yield the lines of a chart; its lines share one drawing.

    Args:
        chart: The chart.
        width: Columns of the terminal.
        height: Lines of the drawing.
    """
    lines = chart.drawn_lines
    if not lines:
        return
    columns = max(width - _LABEL - 1, 10)
    left, right = chart.extent
    low, high = min(line.ys.min() for line in lines), max(line.ys.max() for line in lines)
    if low == high:  # a constant value is drawn in the middle
        low, high = low - 1, high + 1
    cells, owners = np.zeros((height, columns), np.intp), np.zeros((height, columns), np.intp)
    for number, line in enumerate(lines):
        xs = (line.xs - left) / ((right - left) or 1) * (2 * columns - 1)
        ys = (high - line.ys) / (high - low) * (4 * height - 1)
        own = np.zeros_like(cells)
        _plot(own, xs.round().astype(np.intp).tolist(), ys.round().astype(np.intp).tolist())
        cells |= own
        owners[own != 0] = number
    yield _legend(chart)
    for number, (row, colours) in enumerate(zip(cells.tolist(), owners.tolist(), strict=True)):
        label = f"{high:.4g}" if number == 0 else f"{low:.4g}" if number == height - 1 else ""
        yield f"{label:>{_LABEL}} {_row(row, colours, is_coloured=len(lines) > 1)}"
    first, last = (f"{round(end, 3):.4g} {chart.axis}" for end in (left, right))
    yield f"{'':{_LABEL}} {first}{last:>{max(columns - len(first), len(last) + 1)}}"


def _legend(chart: Chart) -> str:
    """Return title and unit, and the name of each line in its colour where there are several."""
    title = f"{chart.title} [{chart.unit}]" if chart.unit else chart.title
    lines = chart.drawn_lines
    if len(lines) == 1:
        label = lines[0].label
        return title if label.lower() == chart.title.lower() else f"{title}: {label}"
    names = [
        coloured(f"━ {line.label}", _COLOURS[number % len(_COLOURS)]) for number, line in enumerate(lines)
    ]
    return f"{title}   {'   '.join(names)}"


def _row(row: list[int], owners: list[int], *, is_coloured: bool) -> str:
    """Return a row of cells; neighbours of one colour are one text."""
    letters = [chr(_BRAILLE + cell) for cell in row]
    if not is_coloured:
        return "".join(letters)
    parts: list[str] = []
    for owner, run in groupby(range(len(letters)), key=owners.__getitem__):
        parts.append(coloured("".join(letters[index] for index in run), _COLOURS[owner % len(_COLOURS)]))
    return "".join(parts)


def _plot(
    cells: np.ndarray[tuple[int, int], np.dtype[np.intp]], xs: Sequence[int], ys: Sequence[int]
) -> None:
    """Set the points, and those between two neighbours in height."""
    lowest: dict[int, int] = {}
    highest: dict[int, int] = {}
    for x, y in zip(xs, ys, strict=True):
        lowest[x], highest[x] = min(lowest.get(x, y), y), max(highest.get(x, y), y)
    for x, top in lowest.items():
        for y in range(top, highest[x] + 1):
            cells[y // 4, x // 2] |= _BITS[y % 4][x % 2]
