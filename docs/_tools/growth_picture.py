"""Make docs/images/growth.svg: CPU time of a packet over the number of vehicles and of subscriptions.

Run `python -m docs._tools.growth_picture FIGURES.json` with the figures of
`python -m benchmarks.growth --json FIGURES.json`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from docs._tools.swarm_pictures import IMAGES, plot, svg

SERIES = {"cpu": "least", "worst": "most"}


def growth(figures: list[dict[str, Any]]) -> str:
    """Return the picture of the figures."""
    vehicles = [row for row in figures if row["subscriptions"] == 1]
    subscriptions = [row for row in figures if row["vehicles"] == 1]
    left = plot("CPU µs per packet, 1 subscription", vehicles, SERIES)
    right = plot("CPU µs per packet, 1 vehicle", subscriptions, SERIES, "subscriptions")
    return svg(760, 250, f'{left}<g transform="translate(380 0)">{right}</g>')


if __name__ == "__main__":
    (IMAGES / "growth.svg").write_text(growth(json.loads(Path(sys.argv[1]).read_text("utf-8"))), "utf-8")
