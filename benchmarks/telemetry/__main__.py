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

    from .receiver import Method

TURNS, SECONDS, FLOOD_SECONDS = 5, 8.0, 2.0
QUICK_TURNS, QUICK_SECONDS, QUICK_FLOOD = 1, 3.0, 1.0
#: The quick run uses the pace of the vehicle only.
PACES = (report.AS_SENT, report.SPREAD)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the benchmarks, and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.telemetry", description="Compare receivers.")
    parser.add_argument("--turns", type=int, help=f"turns of each receiver (default: {TURNS})")
    parser.add_argument("--seconds", type=float, help=f"duration of a turn (default: {SECONDS:g})")
    parser.add_argument("--only", nargs="+", default=[], help="prefixes of receiver names")
    parser.add_argument("--quick", action="store_true", help="about two minutes")
    parser.add_argument("--json", action="store_true", help="every turn, for a script")
    options = parser.parse_args(arguments)
    count = options.turns or (QUICK_TURNS if options.quick else TURNS)
    seconds = options.seconds or (QUICK_SECONDS if options.quick else SECONDS)
    methods = [
        method for method in installed() if not options.only or method.name.startswith(tuple(options.only))
    ]
    measured = _measure(methods, count, seconds, quick=options.quick)
    conditions = (
        f"machine  {machine()}",
        f"turns    {count}, interleaved; figures, differences and ratios are medians over the turns",
        f"load     {' '.join(f'{load:.2f}' for load in os.getloadavg())} (1, 5, 15 minutes)",
    )
    print(report.as_json(measured) if options.json else report.table(measured, conditions))


def _measure(
    methods: Sequence[Method], count: int, seconds: float, *, quick: bool
) -> dict[str, report.Measurements]:
    sent = recording.record(turns.WARM_UP_TIME + seconds + 2.0)
    packets = {report.AS_SENT: sent, report.SPREAD: recording.spread(sent)}
    measured = {method.name: report.Measurements() for method in methods}
    for turn in range(count):
        for method in methods:
            _log(f"turn {turn + 1} of {count}: {method.name}")
            for pace in PACES[:1] if quick else PACES:
                measured[method.name].paced.setdefault(pace, []).append(turns.paced(method, packets[pace]))
            if method.floods:
                length = QUICK_FLOOD if quick else FLOOD_SECONDS
                measured[method.name].flooded.append(turns.flood(method, sent, length))
    return measured


def _log(text: str) -> None:
    if sys.stderr.isatty():
        print(text, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
