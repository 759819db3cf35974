"""`python -m benchmarks.transfers [--vehicles FILE] [--conditions a b …] [--turns N] [--json]`."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.channels import CONDITIONS

from . import report, session, vehicles
from .model import Work

if TYPE_CHECKING:
    from collections.abc import Sequence

TURNS, QUICK_TURNS = 5, 3
BRIEF_TURNS, QUICK_BRIEF_TURNS = 3, 1
CLEAN = "a"
DEFAULT_TIMEOUT = 180.0


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the transfers, and print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.transfers", description="Compare transfers.")
    parser.add_argument(
        "--vehicles", type=Path, help="JSON file, see transfers/vehicles.py; default: Mavstack"
    )
    parser.add_argument("--conditions", nargs="+", choices=list(CONDITIONS), default=list(CONDITIONS))
    parser.add_argument("--works", nargs="+", type=Work, choices=list(Work), default=list(Work))
    parser.add_argument("--clients", nargs="+", default=[], help="names of clients; default: all")
    parser.add_argument("--only", nargs="+", default=[], help="names of vehicles; default: all")
    parser.add_argument("--turns", type=int, default=TURNS)
    parser.add_argument(
        "--timeout",
        type=float,
        default=DEFAULT_TIMEOUT,
        help="seconds after which a transfer counts as failed",
    )
    parser.add_argument("--quick", action="store_true", help=f"{QUICK_TURNS} turns")
    parser.add_argument("--json", action="store_true", help="every turn, for a script")
    parser.add_argument(
        "--brief",
        action="store_true",
        help="a simulated vehicle over a clean link, which takes minutes instead of an hour",
    )
    options = parser.parse_args(arguments)
    turns = QUICK_TURNS if options.quick else options.turns
    if options.brief:
        options.conditions, turns = [CLEAN], QUICK_BRIEF_TURNS if options.quick else BRIEF_TURNS
    run = session.Run(options.conditions, options.works, turns, options.timeout, _log, options.clients)
    with tempfile.TemporaryDirectory(prefix="mavstack-vehicle-") as folder:
        known = _vehicles(options, Path(folder))
        chosen = [item for item in known if not options.only or item.name in options.only]
        cells = list(session.measure(chosen, run))
    print((report.as_json if options.json else report.table)(cells))


def _vehicles(options: argparse.Namespace, folder: Path) -> list[vehicles.Vehicle]:
    if options.vehicles:
        return vehicles.read(options.vehicles)
    return [vehicles.simulated() if options.brief else vehicles.ours(folder)]


def _log(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
