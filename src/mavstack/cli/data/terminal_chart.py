"""Charts on a terminal, drawn with Braille patterns: eight points in each cell."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.logs.report.charts import Chart

#: Bits of the Braille pattern of a cell, by row and column.
_BITS: Final = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
_BRAILLE: Final = 0x2800
_LABEL: Final = 10


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
    if low == high:  # a constant is drawn in the middle
        low, high = low - 1, high + 1
    cells = np.zeros((height, columns), np.intp)
    for line in lines:
        xs = (line.xs - left) / ((right - left) or 1) * (2 * columns - 1)
        ys = (high - line.ys) / (high - low) * (4 * height - 1)
        _plot(cells, xs.round().astype(np.intp).tolist(), ys.round().astype(np.intp).tolist())
    unit = f" [{chart.unit}]" if chart.unit else ""
    yield f"{chart.title}{unit}: {', '.join(line.label for line in lines)}"
    for number, row in enumerate(cells.tolist()):
        label = f"{high:.6g}" if number == 0 else f"{low:.6g}" if number == height - 1 else ""
        yield f"{label:>{_LABEL}} {''.join(chr(_BRAILLE + cell) for cell in row)}"
    first, last = (f"{round(end, 3):.4g} {chart.axis}" for end in (left, right))
    yield f"{'':{_LABEL}} {first}{last:>{max(columns - len(first), len(last) + 1)}}"


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
