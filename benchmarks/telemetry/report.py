"""The tables of the telemetry: one line per receiver with medians, minima and maxima over the turns."""

from __future__ import annotations

import json
import statistics
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING

from benchmarks.measure import OURS

from .receiver import BARE_READER, METHODS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from .turns import Flooded, Paced

MICRO, MILLI = 1e6, 1e3
AS_SENT, SPREAD, FLOOD = "as the vehicle sends", "one by one", "at full rate"
PACED_HEAD = (
    *("receiver", "CPU µs", "min … max", "bare", "times ours", "idle ms/s"),
    *("median ms", "added", "p99 ms", "added", "first s", "lost"),
)
_CALLED = frozenset(method.name for method in METHODS if method.is_called)
FLOOD_HEAD = ("receiver", "msg/s", "min … max", "of ours", "CPU µs", "times ours", "lost")


@dataclass(slots=True)
class Measurements:
    """The turns of one receiver."""

    paced: dict[str, list[Paced]] = field(default_factory=dict)  # by the pace
    flooded: list[Flooded] = field(default_factory=list)


def table(measured: dict[str, Measurements], conditions: Iterable[str]) -> str:
    """Return the tables."""
    paces = {pace: None for each in measured.values() for pace in each.paced}
    parts = [_paced(pace, {name: each.paced[pace] for name, each in measured.items()}) for pace in paces]
    flooded = {name: each.flooded for name, each in measured.items() if each.flooded}
    return "\n\n".join((*parts, *([_flooded(flooded)] if flooded else []), "\n".join(conditions)))


def as_json(measured: dict[str, Measurements]) -> str:
    """Return every turn as JSON."""
    return json.dumps({name: asdict(each) for name, each in measured.items()}, indent=2, ensure_ascii=False)


def _paced(pace: str, turns: dict[str, list[Paced]]) -> str:
    rate = statistics.median(turn.rate for each in turns.values() for turn in each)
    bare, ours = turns.get(BARE_READER), turns.get(OURS)
    rows = [
        (
            name,
            f"{_median(each, lambda turn: turn.cpu) * MICRO:.1f}",
            _range([turn.cpu * MICRO for turn in each], 1),
            _against(each, bare, lambda turn: turn.cpu * MICRO, "{:+.1f}"),
            _times(each, ours, lambda turn: turn.cpu),
            f"{_median(each, lambda turn: turn.idle) * MILLI:.2f}",
            *(_delays(each, bare) if name in _CALLED else ("",) * 4),
            f"{_median(each, lambda turn: turn.first):.3f}",
            f"{_median(each, lambda turn: turn.lost):.1%}" if name in _CALLED else "",
        )
        for name, each in turns.items()
    ]
    return f"{rate:.0f} messages per second, {pace}\n{_lines(PACED_HEAD, rows)}"


def _flooded(turns: dict[str, list[Flooded]]) -> str:
    ours = turns.get(OURS)
    rows = [
        (
            name,
            f"{_median(each, lambda turn: turn.rate):,.0f}",
            _range([turn.rate for turn in each], 0),
            _times(each, ours, lambda turn: turn.rate),
            f"{_median(each, lambda turn: turn.cpu) * MICRO:.1f}",
            _times(each, ours, lambda turn: turn.cpu),
            f"{_median(each, lambda turn: turn.lost):.1%}",
        )
        for name, each in turns.items()
    ]
    return f"{FLOOD}\n{_lines(FLOOD_HEAD, rows)}"


def _lines(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    widths = [max(len(line[index]) for line in (head, *rows)) for index in range(len(head))]
    output = [
        "  ".join(
            cell.rjust(width) if index else cell.ljust(width)
            for index, (cell, width) in enumerate(zip(line, widths, strict=True))
        )
        for line in (head, ["-" * width for width in widths], *rows)
    ]
    return "\n".join(line.rstrip() for line in output)


def _median(turns: Sequence[Paced] | Sequence[Flooded], of: Callable[..., float]) -> float:
    return statistics.median(of(turn) for turn in turns)


def _range(values: Sequence[float], digits: int) -> str:
    return f"{min(values):,.{digits}f} … {max(values):,.{digits}f}"


def _delays(turns: Sequence[Paced], bare: Sequence[Paced] | None) -> tuple[str, ...]:
    """Return median and 99 % of the delay, each with the difference to the bare reader."""
    return (
        f"{_median(turns, lambda turn: turn.median) * MILLI:.3f}",
        _against(turns, bare, lambda turn: turn.median * MILLI, "{:+.3f}"),
        f"{_median(turns, lambda turn: turn.p99) * MILLI:.3f}",
        _against(turns, bare, lambda turn: turn.p99 * MILLI, "{:+.3f}"),
    )


def _against(
    turns: Sequence[Paced], base: Sequence[Paced] | None, of: Callable[[Paced], float], form: str
) -> str:
    """Return the median difference to the bare reader of the same turn."""
    if base is None or base is turns:
        return ""
    differences = [of(turn) - of(base_turn) for turn, base_turn in zip(turns, base, strict=True)]
    return form.format(statistics.median(differences))


def _times(
    turns: Sequence[Paced] | Sequence[Flooded],
    ours: Sequence[Paced] | Sequence[Flooded] | None,
    of: Callable[..., float],
) -> str:
    """Return the median of the ratios of the turns."""
    if ours is None or ours is turns:
        return ""
    ratios = (of(turn) / of(our_turn) for turn, our_turn in zip(turns, ours, strict=True))
    return f"{statistics.median(ratios):.2f}"
