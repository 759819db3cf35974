"""The report of a run: a table for the terminal, or JSON."""

from __future__ import annotations

import json
import os
import platform
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from . import best
from .measure import OURS, PYMAVLINK, C, Ratio, Row

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

HEAD = ("work", OURS, PYMAVLINK, C, "ratio", "min … max", "must reach", "reached", "best so far")


@dataclass(frozen=True, slots=True)
class Conditions:
    """The conditions of a run."""

    workload: str
    compiler: str
    turns: int


def machine() -> str:
    """Return the processor, the number of cores and the versions."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        model = next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        model = platform.processor() or platform.machine()
    return (
        f"{model}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}, "
        f"pymavlink {version('pymavlink')}, mavstack {version('mavstack')}"
    )


def table(rows: Iterable[Row], conditions: Conditions) -> str:
    """Return all measurements as a table."""
    known = best.read()
    lines = [HEAD, *(line for row in rows for line in _lines(row, known))]
    widths = [max(len(line[index]) for line in lines) for index in range(len(HEAD))]
    output = [
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in lines
    ]
    output.insert(1, "  ".join("-" * width for width in widths))
    conditions_text = (
        f"machine     {machine()}",
        f"C library   {conditions.compiler}",
        f"workload    {conditions.workload}",
        f"turns       {conditions.turns}, interleaved; the ratio is the median of the turns' ratios",
        f"load        {' '.join(f'{load:.2f}' for load in os.getloadavg())} (1, 5, 15 minutes)",
    )
    return "\n".join((*(line.rstrip() for line in output), "", *conditions_text))


def as_json(rows: Iterable[Row], conditions: Conditions) -> str:
    """Return all measurements with every turn as JSON."""
    return json.dumps(
        {
            "machine": machine(),
            "compiler": conditions.compiler,
            "workload": conditions.workload,
            "turns": conditions.turns,
            "rows": [
                {"work": row.work, "figures": dict(row.figures), "ratios": [_ratio(r) for r in row.ratios]}
                for row in rows
            ],
        },
        indent=2,
        ensure_ascii=False,
    )


def _ratio(ratio: Ratio) -> dict[str, object]:
    return {
        "ratio": ratio.label,
        "median": ratio.median,
        "seen": list(ratio.values),
        "target": ratio.target,
        "sense": "at least" if ratio.higher_is_better else "at most",
        "reached": ratio.reached,
    }


def _lines(row: Row, known: best.Best) -> list[Sequence[str]]:
    names = (row.work, *(row.figures.get(name, "-") for name in (OURS, PYMAVLINK, C)))
    blank = ("", "", "", "")
    return [
        (*(blank if index else names), *_verdict(ratio), best.describe(known, row.work, ratio))
        for index, ratio in enumerate(row.ratios)
    ]


def _verdict(ratio: Ratio) -> tuple[str, str, str, str]:
    figure = f"{_short(ratio.median)} {ratio.label}"
    spread = f"{_short(min(ratio.values))} … {_short(max(ratio.values))}"
    if ratio.target is None:
        return figure, spread, "", ""
    sign = "≥" if ratio.higher_is_better else "≤"
    return figure, spread, f"{sign} {ratio.target:g}", "yes" if ratio.reached else "NO"


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"
