"""The best ratios of earlier runs, in a file of the repository, so that a loss of speed is seen.

Ratios to a peer on one machine say more than times: the same machine runs both in turn. `--record` writes the
ratios of a run that are better than those of the file.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .measure import Ratio, Row

FILE: Final = Path(__file__).with_name("best.json")
#: Share of the best ratio whose loss is reported.
_TOLERANCE: Final = 0.10

#: Best ratio by work and label.
Best = dict[str, dict[str, float]]


def read(path: Path = FILE) -> Best:
    """Return the best ratios so far."""
    found: Best = json.loads(path.read_text("utf-8"))
    return found


def describe(best: Best, work: str, ratio: Ratio) -> str:
    """Return the best ratio so far, with the loss if it is more than 10 %; empty if none is recorded.

    Args:
        best: The best ratios.
        work: The work of the row.
        ratio: The ratio of today.
    """
    before = best.get(work, {}).get(ratio.label)
    if before is None:
        return ""
    change = ratio.median / before - 1 if ratio.higher_is_better else before / ratio.median - 1
    text = f"{before:.3g}"
    return f"{text} (LOST {-change:.0%})" if change < -_TOLERANCE else text


def updated(best: Best, rows: Iterable[Row]) -> Best:
    """Return the best ratios with those of a run that are better or new.

    Args:
        best: The best ratios so far.
        rows: The rows of the run.
    """
    found = {work: dict(ratios) for work, ratios in best.items()}
    for row in rows:
        for ratio in row.ratios:
            known = found.setdefault(row.work, {})
            choose = max if ratio.higher_is_better else min
            known[ratio.label] = round(choose(known.get(ratio.label, ratio.median), ratio.median), 4)
    return dict(sorted(found.items()))


def write(best: Best, path: Path = FILE) -> None:
    """Write the best ratios."""
    path.write_text(json.dumps(best, indent=1, ensure_ascii=False) + "\n", "utf-8")
