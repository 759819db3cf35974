"""The table of the transfers: median and spread of each client, failures, and our ratio to each."""

from __future__ import annotations

import json
import statistics
from collections import Counter
from dataclasses import asdict
from typing import TYPE_CHECKING

from benchmarks.channels import CONDITIONS
from benchmarks.measure import OURS, Ratio

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from .model import Outcome
    from .session import Cell

HEAD = (
    "vehicle",
    "",
    "work",
    "client",
    "median s",
    "min … max",
    "failed",
    "ours / peer",
    "spread",
    "problem",
)
MAX_PROBLEM_WIDTH = 60


def median(outcomes: Sequence[Outcome]) -> float | None:
    """Return the median of the finished turns; None unless more than half of the turns finished."""
    seen = [item.seconds for item in outcomes if item.finished and item.seconds is not None]
    return statistics.median(seen) if 2 * len(seen) > len(outcomes) else None


def best_peer(cell: Cell) -> str | None:
    """Return the peer with the smallest median."""
    medians = {name: median(seen) for name, seen in cell.outcomes.items() if not name.startswith(OURS)}
    return (
        min((m, name) for name, m in medians.items() if m is not None)[1] if any(medians.values()) else None
    )


def ratio(cell: Cell, peer: str) -> Ratio | None:
    """Return our seconds over those of the peer, turn by turn, where both finished."""
    pairs = zip(cell.outcomes.get(OURS, ()), cell.outcomes[peer], strict=False)
    seen = tuple(
        ours.seconds / theirs.seconds
        for ours, theirs in pairs
        if ours.finished and theirs.finished and ours.seconds is not None and theirs.seconds
    )
    return Ratio(f"of {peer}", seen, None, higher_is_better=False) if seen else None


def table(cells: Iterable[Cell]) -> str:
    """Return the table; the best peer of a cell is marked by an asterisk."""
    lines = [HEAD, *(line for cell in cells for line in _lines(cell))]
    widths = [max(len(line[index]) for line in lines) for index in range(len(HEAD))]
    rows = ["  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in lines]
    rows.insert(1, "  ".join("-" * width for width in widths))
    conditions = [f"{letter}  {description}" for letter, (description, _) in CONDITIONS.items()]
    return "\n".join((*(line.rstrip() for line in rows), "", *conditions))


def as_json(cells: Iterable[Cell]) -> str:
    """Return every turn of every client as JSON."""
    return json.dumps([asdict(cell) for cell in cells], indent=2, ensure_ascii=False)


def _lines(cell: Cell) -> list[tuple[str, ...]]:
    best = best_peer(cell)
    return [
        (
            *(cell.vehicle, cell.condition, cell.work),
            f"{name} *" if name == best else name,
            *_figures(seen),
            *_against(cell, name),
            _frequent_problem(seen),
        )
        for name, seen in cell.outcomes.items()
    ]


def _figures(seen: Sequence[Outcome]) -> tuple[str, str, str]:
    seconds = [item.seconds for item in seen if item.finished and item.seconds is not None]
    middle = median(seen)
    return (
        "failed" if middle is None else _short(middle),
        f"{_short(min(seconds))} … {_short(max(seconds))}" if seconds else "",
        f"{len(seen) - len(seconds)} of {len(seen)}" if len(seconds) < len(seen) else "",
    )


def _against(cell: Cell, name: str) -> tuple[str, str]:
    found = ratio(cell, name) if not name.startswith(OURS) else None
    if found is None:
        return "", ""
    return f"{found.median:.2f}", f"{min(found.values):.2f} … {max(found.values):.2f}"


def _frequent_problem(seen: Sequence[Outcome]) -> str:
    problems = Counter(item.problem for item in seen if item.problem)
    return problems.most_common(1)[0][0][:MAX_PROBLEM_WIDTH] if problems else ""


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"
