"""A tlog to Parquet, beside mavlogdump to CSV, and to the page of a report; one message of a large tlog.

mavlogdump is asked for all messages. Its start is subtracted, which is measured with an empty log. The memory
of the export is the peak of a process of its own.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Final

import mavstack
from mavstack.logs.export import export_log
from mavstack.logs.report import make_report

from . import memory
from .measure import OURS, Ratio, Row, rates, speed_ratio, take_turns
from .onboard_logs import one_type

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .rows import Bench

DUMP: Final = "mavlogdump"
_REPORT_SECONDS: Final = 5.0
_REPORT_SIZE: Final = 100_000_000


def rows(bench: Bench) -> Iterator[Row]:
    """Measure the export to Parquet, its memory, the report, and the decoding of one message."""
    few = bench.amounts.slow
    whole, many = bench.tlog(bench.amounts.tlog_size)
    slice_ = bench.file("slice.tlog", partial(bench.flight.tlog, few))
    empty = bench.file("empty.tlog", lambda: b"")
    work: dict[str, Callable[[], float]] = {
        DUMP: partial(_dump, slice_, empty, few, ",".join(mavstack.open_log(slice_))),
        OURS: partial(_export, whole, bench.folder / "dataset", many),
    }
    results = take_turns(work, max(bench.amounts.turns // 2, 3))
    yield Row("tlog to Parquet, all messages", rates(results), (speed_ratio(results, DUMP, 100),))
    yield memory.conversion(whole, bench.folder / "dataset")
    path, _ = bench.tlog(_REPORT_SIZE)
    seconds = [_report(path) for _ in range(3)]
    share = tuple(each / _REPORT_SECONDS for each in seconds)
    figures = {OURS: f"{min(seconds):.1f} s"}
    title = f"report of a tlog of {path.stat().st_size / 1e6:.0f} MB"
    yield Row(title, figures, (Ratio("of 5 s", share, 1, higher_is_better=False),))
    path, _ = bench.tlog(bench.amounts.large_size)
    yield one_type(path, "ATTITUDE", bench.amounts.turns)


def _export(log: Path, target: Path, count: int) -> float:
    shutil.rmtree(target, ignore_errors=True)
    started = perf_counter()
    export_log(mavstack.open_log(log), "parquet", target)
    return (perf_counter() - started) / count


def _dump(log: Path, empty: Path, count: int, names: str) -> float:
    return (_dump_seconds(log, names) - _dump_seconds(empty, names)) / count


def _dump_seconds(log: Path, names: str) -> float:
    script = Path(sys.executable).with_name("mavlogdump.py")
    started = perf_counter()
    subprocess.run(
        [sys.executable, str(script), "--format", "csv", "--types", names, str(log)],
        check=False,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    return perf_counter() - started


def _report(log: Path) -> float:
    started = perf_counter()
    make_report(mavstack.open_log(log))
    return perf_counter() - started
