"""Make the pictures of the guide on swarms: formations, search patterns, and the cost of each vehicle.

Run `python docs/_tools/swarm_pictures.py [FIGURES.json]`. It writes `docs/images/swarm-formations.svg` and
`docs/images/swarm-patterns.svg`, and with the figures of `python -m benchmarks.swarm_scaling --json
FIGURES.json` also `docs/images/swarm-scaling.svg`. Colours are readable on light and on dark pages.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mavstack.swarm.formations import FORMATIONS, Formation
from mavstack.swarm.search import patterns

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.swarm.arrays import Points

IMAGES = Path(__file__).parents[1] / "images"
#: Pixels of one picture, of its title and of its margin; pictures in a row.
SIZE, TITLE, MARGIN, COLUMNS = 150, 22, 16, 5
INK, ACCENT, OTHER = "#6b7785", "#0080c0", "#d55e00"
#: Members of a formation, and points of the shape that programs give.
MEMBERS = 9
OWN_POINTS = [(0, 0, 0), (-4, -8, 0), (-4, 8, 0), (-12, -8, 0), (-12, 8, 0), (-16, 0, 0), (-8, 0, 0)]


def formations() -> str:
    """Return the picture of all formations: from above, the direction of motion up; a text from behind."""
    cells = []
    for name in FORMATIONS:
        count = {"text": 13, "points": len(OWN_POINTS), "sphere": 20}.get(name, MEMBERS)
        shape = Formation(
            name,
            spacing=10.0,
            text="M" if name == "text" else "",
            points=OWN_POINTS if name == "points" else (),
        )
        offsets = shape.offsets(count)
        if name == "text":  # from behind, up for ahead
            offsets = offsets[:, [2, 1, 0]]
        cells.append((name, _dots(offsets)))
    return _page(cells)


def search_patterns() -> str:
    """Return the picture of all search patterns, north up; each begins at the disc."""
    route = [(0.0, 0.0), (60.0, 20.0), (70.0, 80.0)]
    found = {
        "parallel track": patterns.parallel_track(120.0, 80.0, 16.0),
        "creeping line": patterns.creeping_line(120.0, 80.0, 16.0),
        "expanding square": patterns.expanding_square(12.0, 12),
        "sector": patterns.sector(60.0),
        "track line": patterns.track_line(route, 10.0, sides=2),
    }
    return _page([(name, _path(points)) for name, points in found.items()])


def scaling(figures: Sequence[dict[str, Any]]) -> str:
    """Return the plot of processor time and bytes of each vehicle over the number of vehicles."""
    plots = [
        plot(
            "processor time, ms/s per vehicle", figures, {"cpu_ms": "program", "controller_ms": "controller"}
        ),
        plot("bytes/s per vehicle", figures, {"sent": "to it", "received": "from it"}),
    ]
    return svg(
        680, 240, "".join(f'<g transform="translate({340 * i} 0)">{each}</g>' for i, each in enumerate(plots))
    )


def _dots(offsets: Points) -> str:
    """Return the slots from above; a higher slot is larger, the leader is coloured."""
    places = _fitted(np.column_stack((offsets[:, 1], -offsets[:, 0])))
    heights = offsets[:, 2] - offsets[:, 2].min()
    sizes = 4.0 + 3.0 * heights / max(float(heights.max()), 1e-9)
    return "".join(
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{size:.1f}" fill="{INK if index else ACCENT}"/>'
        for index, ((x, y), size) in enumerate(zip(places.tolist(), sizes.tolist(), strict=True))
    )


def _path(points: Points) -> str:
    """Return a pattern as a line with a disc at its begin."""
    places = _fitted(np.column_stack((points[:, 1], -points[:, 0]))).tolist()
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
    return (
        f'<polyline points="{line}" fill="none" stroke="{ACCENT}" stroke-width="1.5"/>'
        f'<circle cx="{places[0][0]:.1f}" cy="{places[0][1]:.1f}" r="4" fill="{OTHER}"/>'
    )


def _fitted(points: Points) -> Points:
    """Return points in the pixels of a picture, with equal scales."""
    low, high = points.min(axis=0), points.max(axis=0)
    scale = (SIZE - 2 * MARGIN) / max(float((high - low).max()), 1e-9)
    fitted: Points = (points - (low + high) / 2.0) * scale + SIZE / 2.0
    return fitted


def _page(cells: Sequence[tuple[str, str]]) -> str:
    """Return pictures with their titles in rows."""
    rows = math.ceil(len(cells) / COLUMNS)
    parts = [
        f'<g transform="translate({SIZE * (index % COLUMNS)} {(SIZE + TITLE) * (index // COLUMNS)})">'
        f"{_text(SIZE / 2, 16, title, 'middle')}"
        f'<g transform="translate(0 {TITLE})">{picture}</g></g>'
        for index, (title, picture) in enumerate(cells)
    ]
    return svg(SIZE * COLUMNS, (SIZE + TITLE) * rows, "".join(parts))


def plot(
    title: str, figures: Sequence[dict[str, Any]], series: dict[str, str], over: str = "vehicles"
) -> str:
    """Return a plot whose horizontal axis is logarithmic."""
    counts = [each[over] for each in figures]
    largest = max(float(each[key]) for each in figures for key in series)
    unit = math.pow(10.0, math.floor(math.log10(largest)))
    top = unit * math.ceil(largest / unit)
    across = {count: 50.0 + 230.0 * math.log(count / counts[0], counts[-1] / counts[0]) for count in counts}

    def up(value: float) -> float:
        return 200.0 - 160.0 * value / top

    parts = [_text(165, 16, title, "middle")]
    parts += [_text(across[count], 218, str(count), "middle") for count in counts]
    parts += [_text(44, up(value) + 4, f"{value:g}", "end") for value in (0.0, top / 2.0, top)]
    parts.append(f'<path d="M50 40V200H300" fill="none" stroke="{INK}"/>')
    parts.append(_text(165, 236, over, "middle"))
    for (key, name), colour in zip(series.items(), (ACCENT, OTHER), strict=True):
        line = " ".join(f"{across[each[over]]:.1f},{up(each[key]):.1f}" for each in figures)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        parts.append(_text(285, up(figures[-1][key]) + 4, name, "start", colour))
    return "".join(parts)


def _text(x: float, y: float, text: str, anchor: str, colour: str = INK) -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}" fill="{colour}">{text}</text>'


def svg(width: int, height: int, content: str) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'font-family="sans-serif" font-size="11">{content}</svg>\n'
    )


def main(figures: str | None) -> None:
    """Write the pictures."""
    (IMAGES / "swarm-formations.svg").write_text(formations(), "utf-8")
    (IMAGES / "swarm-patterns.svg").write_text(search_patterns(), "utf-8")
    if figures is not None:
        values = json.loads(Path(figures).read_text("utf-8"))
        (IMAGES / "swarm-scaling.svg").write_text(scaling(values), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
