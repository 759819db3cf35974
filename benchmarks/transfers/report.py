"""The table of the transfers: everyone's median and spread, how often one never ended, ours against each."""

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
    "least … greatest",
    "never",
    "ours / it",
    "spread",
    "why",
)
WHY_WIDTH = 60


def median(outcomes: Sequence[Outcome]) -> float | None:
    """The median of the turns that finished; None unless more than half of them did."""
    seen = [one.seconds for one in outcomes if one.finished and one.seconds is not None]
    return statistics.median(seen) if 2 * len(seen) > len(outcomes) else None


def best_peer(cell: Cell) -> str | None:
    """The peer with the least median."""
    medians = {name: median(seen) for name, seen in cell.outcomes.items() if not name.startswith(OURS)}
    return (
        min((m, name) for name, m in medians.items() if m is not None)[1] if any(medians.values()) else None
    )


def ratio(cell: Cell, peer: str) -> Ratio | None:
    """Ours over the peer's seconds, turn by turn, where both finished."""
    pairs = zip(cell.outcomes.get(OURS, ()), cell.outcomes[peer], strict=False)
    seen = tuple(
        ours.seconds / theirs.seconds
        for ours, theirs in pairs
        if ours.finished and theirs.finished and ours.seconds is not None and theirs.seconds
    )
    return Ratio(f"of {peer}", seen, None, at_least=False) if seen else None


def table(cells: Iterable[Cell]) -> str:
    """Everything, for a terminal; the best peer of a cell has an asterisk."""
    lines = [HEAD, *(line for cell in cells for line in _lines(cell))]
    widths = [max(len(line[place]) for line in lines) for place in range(len(HEAD))]
    told = ["  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in lines]
    told.insert(1, "  ".join("-" * width for width in widths))
    facts = [f"{letter}  {what}" for letter, (what, _) in CONDITIONS.items()]
    return "\n".join((*(line.rstrip() for line in told), "", *facts))


def as_json(cells: Iterable[Cell]) -> str:
    """Every turn of everyone, for a script."""
    return json.dumps([asdict(cell) for cell in cells], indent=2, ensure_ascii=False)


def _lines(cell: Cell) -> list[tuple[str, ...]]:
    best = best_peer(cell)
    return [
        (
            *(cell.vehicle, cell.condition, cell.work),
            f"{name} *" if name == best else name,
            *_figures(seen),
            *_against(cell, name),
            _why(seen),
        )
        for name, seen in cell.outcomes.items()
    ]


def _figures(seen: Sequence[Outcome]) -> tuple[str, str, str]:
    seconds = [one.seconds for one in seen if one.finished and one.seconds is not None]
    middle = median(seen)
    return (
        "never" if middle is None else _short(middle),
        f"{_short(min(seconds))} … {_short(max(seconds))}" if seconds else "",
        f"{len(seen) - len(seconds)} of {len(seen)}" if len(seconds) < len(seen) else "",
    )


def _against(cell: Cell, name: str) -> tuple[str, str]:
    told = ratio(cell, name) if not name.startswith(OURS) else None
    if told is None:
        return "", ""
    return f"{told.median:.2f}", f"{min(told.seen):.2f} … {max(told.seen):.2f}"


def _why(seen: Sequence[Outcome]) -> str:
    problems = Counter(one.problem for one in seen if one.problem)
    return problems.most_common(1)[0][0][:WHY_WIDTH] if problems else ""


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"
