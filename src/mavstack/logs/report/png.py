"""Charts as a PNG, drawn by matplotlib."""

from __future__ import annotations

from importlib import import_module
from io import BytesIO
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.logs.report.charts import Chart

_WIDTH: Final = 10.0  # inches
_HEIGHT: Final = 2.6
_DOTS: Final = 110


def png_of(charts: Sequence[Chart]) -> bytes:
    """Return charts below each other as a PNG.

    Args:
        charts: The charts, at least one.

    Returns:
        The content of the file.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    try:
        # Without pyplot, which would open a window where there is a display.
        figures = import_module("matplotlib.figure")
    except ImportError:
        raise MissingExtraError("a plot as PNG", "plot") from None
    figure = figures.Figure(figsize=(_WIDTH, _HEIGHT * len(charts)), dpi=_DOTS, layout="constrained")
    for axes, chart in zip(figure.subplots(len(charts), squeeze=False)[:, 0], charts, strict=True):
        _draw(axes, chart)
    buffer = BytesIO()
    figure.savefig(buffer, format="png")
    return buffer.getvalue()


def _draw(axes: Any, chart: Chart) -> None:  # noqa: ANN401 (matplotlib is optional)
    for line in chart.lines:
        axes.plot(line.xs, line.ys, linewidth=0.9, label=line.label)
    for number, band in enumerate(chart.bands):
        axes.axvspan(band.start, band.end, color="0.5", alpha=0.05 + 0.07 * (number % 2), linewidth=0)
    axes.set_xlim(*chart.extent)
    axes.set_title(chart.title, loc="left", fontsize=10)
    axes.set_ylabel(chart.unit)
    axes.set_xlabel(chart.axis)
    axes.grid(visible=True, alpha=0.3)
    axes.legend(fontsize=8, loc="upper right")
