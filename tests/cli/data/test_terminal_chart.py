"""Charts on the terminal."""

from __future__ import annotations

import numpy as np

from mavstack.cli.common.output import coloured
from mavstack.cli.data.terminal_chart import chart_lines
from mavstack.logs.report.charts import Chart, Line


def line(label, values):
    return Line(label, np.arange(len(values), dtype=float), np.array(values, dtype=float))


def chart(*lines, title="Pitch", unit="deg"):
    return Chart(title, unit, lines)


def test_each_line_of_the_legend_has_its_name_and_colour():
    legend, *rows = chart_lines(chart(line("pitch", [0, 1, 2, 3]), line("pitch, target", [3, 2, 1, 0])), 40)
    assert legend == f"Pitch [deg]   {coloured('━ pitch', 'cyan')}   {coloured('━ pitch, target', 'yellow')}"
    drawing = "".join(rows[:-1])
    assert coloured("━", "cyan")[0] in drawing
    assert coloured("━", "yellow")[0] in drawing


def test_one_line_needs_no_colour_and_no_second_name():
    assert next(chart_lines(chart(line("pitch", [0, 1])), 40)) == "Pitch [deg]"
    assert next(chart_lines(chart(line("radio", [0, 1]), title="Voltage"), 40)) == "Voltage [deg]: radio"
    assert all(row.isprintable() for row in chart_lines(chart(line("pitch", [0, 1, 0])), 40))


def test_labels_of_small_values_keep_the_rows_aligned():
    _, *rows = chart_lines(chart(line("pitch", [-0.00095167123, -0.067955])), 60)
    assert {len(row) for row in rows[:-1]} == {60}
