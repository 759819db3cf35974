"""`python -m benchmarks.telemetry [--quick] [--json] [--turns N] [--seconds N] [--only NAME …]`."""

from __future__ import annotations

import argparse
import os
import sys
from typing import TYPE_CHECKING

from benchmarks.report import machine

from . import recording, report, turns
from .receiver import installed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .receiver import Way

TURNS, SECONDS, FLOOD_SECONDS = 5, 8.0, 2.0
QUICK_TURNS, QUICK_SECONDS, QUICK_FLOOD = 1, 3.0, 1.0
#: The quick run has the vehicle's own pace only.
PACES = (report.AS_SENT, report.SPREAD)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, and print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.telemetry", description="Compare receivers.")
    parser.add_argument("--turns", type=int, help=f"turns of each receiver (default: {TURNS})")
    parser.add_argument("--seconds", type=float, help=f"how long a turn is watched (default: {SECONDS:g})")
    parser.add_argument("--only", nargs="+", default=[], help="receivers whose names begin so")
    parser.add_argument("--quick", action="store_true", help="about two minutes")
    parser.add_argument("--json", action="store_true", help="every turn, for a script")
    options = parser.parse_args(arguments)
    count = options.turns or (QUICK_TURNS if options.quick else TURNS)
    seconds = options.seconds or (QUICK_SECONDS if options.quick else SECONDS)
    ways = [way for way in installed() if not options.only or way.name.startswith(tuple(options.only))]
    seen = _measure(ways, count, seconds, quick=options.quick)
    facts = (
        f"machine  {machine()}",
        f"turns    {count}, interleaved; medians; what is over another's is the median of the turns' own",
        f"load     {' '.join(f'{load:.2f}' for load in os.getloadavg())} (1, 5, 15 minutes)",
    )
    print(report.as_json(seen) if options.json else report.table(seen, facts))


def _measure(ways: Sequence[Way], count: int, seconds: float, *, quick: bool) -> dict[str, report.Seen]:
    sent = recording.record(turns.WARM_UP + seconds + 2.0)
    packets = {report.AS_SENT: sent, report.SPREAD: recording.spread(sent)}
    seen = {way.name: report.Seen() for way in ways}
    for turn in range(count):
        for way in ways:
            _say(f"turn {turn + 1} of {count}: {way.name}")
            for pace in PACES[:1] if quick else PACES:
                seen[way.name].paced.setdefault(pace, []).append(turns.paced(way, packets[pace]))
            if way.floods:
                length = QUICK_FLOOD if quick else FLOOD_SECONDS
                seen[way.name].flooded.append(turns.flood(way, sent, length))
    return seen


def _say(what: str) -> None:
    if sys.stderr.isatty():
        print(what, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
