"""`python -m benchmarks [--quick] [--json] [--only ROW …] [--definitions DIR] [--vehicles FILE]`."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from . import (
    best,
    bridge_programs,
    bridge_requests,
    bridges,
    c_library,
    codegen_c,
    codegen_java_go,
    codegen_lua,
    codegen_python,
    codegen_rust,
    codegen_typescript,
    companion,
    dataflash,
    exports,
    flashing,
    msp,
    recorder,
    report,
    rows,
    sealed,
    simulation,
    swarms,
    ulog,
    watching,
    workload,
)
from .measure import pinned
from .telemetry import __main__ as telemetry
from .transfers import __main__ as transfers
from .transfers import direct

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .measure import Row

ROWS: dict[str, Callable[[rows.Bench], Iterator[Row]]] = {
    "live": lambda bench: iter([rows.live(bench)]),
    "single": lambda bench: iter([rows.single(bench)]),
    "encode": lambda bench: iter([rows.encode(bench)]),
    "verify": lambda bench: iter([rows.verify(bench)]),
    "tlog": rows.tlogs,
    "tlog-1": lambda bench: iter([rows.tlog(bench, threads=1)]),
    "import": rows.first_message,
    "memory": lambda bench: iter([rows.log_memory(bench)]),
    "dataflash": lambda bench: dataflash.rows(bench, quick=bench.amounts is rows.QUICK),
    "ulog": lambda bench: ulog.rows(bench, quick=bench.amounts is rows.QUICK),
    "exports": exports.rows,
    "sealed": sealed.rows,
    "flashing": flashing.rows,
    "msp": msp.rows,
    "bridges": bridges.rows,
    "bridge-programs": bridge_programs.rows,
    "bridge-requests": bridge_requests.rows,
    "swarms": swarms.rows,
    "companion": companion.rows,
    "codegen-c": codegen_c.rows,
    "codegen-python": codegen_python.rows,
    "codegen-typescript": codegen_typescript.rows,
    "codegen-java-go": codegen_java_go.rows,
    "codegen-rust": codegen_rust.rows,
    "codegen-lua": codegen_lua.rows,
}
ON_ALL_CORES = ("tlog", "memory", "dataflash", "ulog", "exports")
# Benchmarks with separate tables.
SIMULATION = "simulation"
TELEMETRY = "telemetry"
RECORDER = "recorder"
WATCHING = "watching"
BRIEF_TRANSFERS = "brief-transfers"
DIRECT_TRANSFERS = "direct-transfers"
TRANSFERS = "transfers"  # runs only on request: it takes an hour
TABLES = (RECORDER, WATCHING, SIMULATION, TELEMETRY, BRIEF_TRANSFERS, DIRECT_TRANSFERS)


def main() -> None:
    """Run the benchmarks, and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description="Measure against the peers.")
    parser.add_argument("--quick", action="store_true", help="fewer messages and turns: about a minute")
    parser.add_argument("--json", action="store_true", help="every turn of every ratio, for a script")
    parser.add_argument("--record", action="store_true", help="write better ratios to best.json")
    parser.add_argument("--only", nargs="+", choices=[*ROWS, *TABLES, TRANSFERS], help="run only these rows")
    parser.add_argument("--vehicles", help="for the transfers: JSON, see transfers/vehicles.py")
    parser.add_argument(
        "--definitions",
        type=Path,
        default=c_library.DEFINITIONS,
        help="folder of the definitions for the C headers (default: those of the project)",
    )
    options = parser.parse_args()
    os.environ["MAVSTACK_CACHE"] = "0"  # logs are indexed, not found in the cache of an earlier run
    selected = options.only or [*ROWS, *TABLES]
    if TRANSFERS in selected:
        _transfers(options)
    selected_rows = [row for row in selected if row in ROWS]
    if selected_rows:
        _rows(options, selected_rows)
    if RECORDER in selected:
        recorder.main(turns=3 if options.quick else 5)
    if WATCHING in selected:
        watching.main(turns=1 if options.quick else 3)
    if SIMULATION in selected:
        simulation.main(["--seconds", "5", "--turns", "1"] if options.quick else [])
    if TELEMETRY in selected:
        telemetry.main(_flags(options))
    if BRIEF_TRANSFERS in selected:
        transfers.main(["--brief", *_flags(options)])
    if DIRECT_TRANSFERS in selected:
        direct.main(["--turns", "2" if options.quick else "5", *(["--json"] if options.json else [])])


def _transfers(options: argparse.Namespace) -> None:
    flags = _flags(options)
    if options.vehicles is not None:
        flags += ["--vehicles", options.vehicles]
    transfers.main(flags)


def _flags(options: argparse.Namespace) -> list[str]:
    return [f"--{name}" for name in ("quick", "json") if getattr(options, name)]


def _rows(options: argparse.Namespace, selected: list[str]) -> None:
    amounts = rows.QUICK if options.quick else rows.FULL
    _log("building the workload and the C library …")
    try:
        program = c_library.build(options.definitions)
        compiler = program.compiler
    except c_library.PeerMissingError as problem:
        program, compiler = None, f"not measured: {problem}"
    flight = workload.build(amounts.log)
    with tempfile.TemporaryDirectory(prefix="mavstack-bench-") as folder:
        bench = rows.Bench(flight, program, amounts, Path(folder))
        measured = _measure(bench, selected)
    output = f"{len(flight):,} messages, {flight.mean_size:.1f} B per packet, seed {workload.SEED}"
    conditions = report.Conditions(output, compiler, amounts.turns)
    print((report.as_json if options.json else report.table)(measured, conditions))
    if options.record:
        best.write(best.updated(best.read(), measured))


def _measure(bench: rows.Bench, selected: list[str]) -> list[Row]:
    measured: list[Row] = []
    for name in (name for name in ROWS if name in selected):
        _log(f"measuring {name} …")
        with nullcontext() if name in ON_ALL_CORES else pinned():
            measured += ROWS[name](bench)
    return measured


def _log(text: str) -> None:
    if sys.stderr.isatty():
        print(text, file=sys.stderr)


if __name__ == "__main__":
    main()
