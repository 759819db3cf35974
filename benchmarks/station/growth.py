"""The memory of the ground station and of its page over half an hour, while clients come and go.

    python -m benchmarks.station.growth [--minutes 30] [--warm-up 5] [--vehicles 100] [--clients 20]

`flights.py` sends the packets of the vehicles to `mav web`, ten times a second each, and Chromium shows the
page. Each of the other clients is a connection of a few seconds: a WebSocket with raw packets that reads or
does not, one with JSON messages, or a request of the API. Each minute has a line: memory of the server's
process without a file behind it (`RssAnon`, the median of the minute) and its open descriptors; memory of the
page's objects and buffers, nodes of its document and event listeners, after a garbage collection.

The last lines are the growth of each figure after the warm-up, the median of the slopes between all minutes,
with the interval that holds it in 95 of 100 cases. The program fails if the interval is above 0.1 percent of
the median a minute.
"""

from __future__ import annotations

import argparse
import json
import sys
from contextlib import ExitStack
from pathlib import Path
from statistics import median
from time import monotonic, sleep
from typing import TYPE_CHECKING

from .__main__ import HOST, process, station
from .page import Page, shown
from .trend import MIN_VALUES, trend
from .visitors import Visitors

if TYPE_CHECKING:
    from collections.abc import Callable

#: Seconds between two clients.
CLIENT_INTERVAL = 0.2
MINUTE = 60.0
SERVER_MEMORY, DESCRIPTORS = "server MB", "descriptors"


def server_memory(pid: int) -> float:
    """Return the memory of a process that no file is behind, in MB."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith("RssAnon")).split()[1]) / 1000


def wait(seconds: float, page: Page | None) -> None:
    """Wait, and let the driver of the browser work."""
    if page is None:
        sleep(seconds)
    else:
        page.page.wait_for_timeout(seconds * 1000)


def minute(pid: int, visitors: Visitors, page: Page | None) -> dict[str, float]:
    """Let clients come and go for a minute, and return the figures at its end."""
    memory: list[float] = []
    end = monotonic() + MINUTE
    while monotonic() < end:
        visitors.step()
        memory.append(server_memory(pid))
        wait(CLIENT_INTERVAL, page)
    descriptors = len(list(Path(f"/proc/{pid}/fd").iterdir()))
    figures = {SERVER_MEMORY: median(memory), DESCRIPTORS: float(descriptors)}
    return figures | (page.counts() if page is not None else {})


def run(
    options: argparse.Namespace, report: Callable[[int, dict[str, float]], None]
) -> list[dict[str, float]]:
    """Run the station under load, report the figures of each minute, and return them all."""
    figures: list[dict[str, float]] = []
    with ExitStack() as running:
        pid, port, source = running.enter_context(station())
        running.enter_context(process("benchmarks.station.flights", source, options.vehicles))
        url = f"http://{HOST}:{port}/#/fly"
        page = running.enter_context(shown(url)) if options.page else None
        visitors = Visitors(port, options.clients)
        running.callback(visitors.close)
        for number in range(1, options.minutes + 1):
            figures.append(minute(pid, visitors, page))
            report(number, figures[-1])
    return figures


def _report(number: int, figures: dict[str, float]) -> None:
    values = "  ".join(f"{name} {value:8.2f}" for name, value in figures.items())
    print(f"{number:3} min  {values}", flush=True)


def main() -> None:
    """Run, print the growth of each figure, and fail if one grows."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.station.growth")
    parser.add_argument("--minutes", type=int, default=30)
    parser.add_argument("--warm-up", type=int, default=5, help="minutes that the growth leaves out")
    parser.add_argument("--vehicles", type=int, default=100)
    parser.add_argument("--clients", type=int, default=20)
    parser.add_argument("--no-page", dest="page", action="store_false", help="the server alone")
    options = parser.parse_args()
    if options.minutes < options.warm_up + MIN_VALUES:
        parser.error(f"--minutes must be at least {MIN_VALUES} more than --warm-up")
    figures = run(options, _report)[options.warm_up :]
    trends = {name: trend([each[name] for each in figures]) for name in figures[0]}
    for name, found in trends.items():
        print(f"{name:12} {found}  {'GROWS' if found.grows else 'does not grow'}")
    print(json.dumps({name: found._asdict() for name, found in trends.items()}))
    sys.exit(any(found.grows for found in trends.values()))


if __name__ == "__main__":
    main()
