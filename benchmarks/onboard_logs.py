"""The rows of an onboard log: its columns beside a peer that reads a part of it, and the memory they take."""

from __future__ import annotations

import os
import statistics
from dataclasses import dataclass
from functools import partial
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Final
from unittest.mock import patch

import mavstack
from mavstack.logs import saved_index as cached

from . import memory
from .measure import OURS, Ratio, Row, rates, speed_ratio, take_turns

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path
    from typing import Any

    from .rows import Bench

FULL_SIZE, QUICK_SIZE = 420_000_000, 60_000_000
ONE_THREAD: Final = "one thread"


@dataclass(frozen=True, slots=True)
class OnboardLog:
    """A kind of log: its suffix, how it is made, and who reads it.

    `write` makes a file of a size and returns the number of its records. `check` raises if the readers
    differ. `count` returns the number of records in the tables of a reader. `one_type` is the table that is
    decoded alone.
    """

    suffix: str
    part_size: int
    write: Callable[[Path, int], int]
    check: Callable[[Path], None]
    count: Callable[[Mapping[str, Any]], int]
    ours: Callable[..., Mapping[str, Any]]
    peer: str
    theirs: Callable[[Path], Mapping[str, Any]]
    target: float
    one_type: str


def measure(bench: Bench, log: OnboardLog, *, quick: bool) -> Iterator[Row]:
    """Compare speed and memory of decoding a log; the peer reads a part of it."""
    turns, size = bench.amounts.turns, QUICK_SIZE if quick else FULL_SIZE
    whole, part = bench.folder / f"flight{log.suffix}", bench.folder / f"part{log.suffix}"
    many, few = log.write(whole, size), log.write(part, log.part_size)
    log.check(part)
    work: dict[str, Callable[[], float]] = {
        log.peer: partial(_timed, log.count, log.theirs, part, few),
        OURS: partial(_timed, log.count, log.ours, whole, many),
        ONE_THREAD: partial(_timed, log.count, partial(log.ours, threads=1), whole, many),
    }
    results = take_turns(work, turns)
    one_thread = zip(results[log.peer], results.pop(ONE_THREAD), strict=True)
    yield Row(
        f"{log.suffix} of {whole.stat().st_size / 1e6:.0f} MB to columns",
        rates(results),
        (
            speed_ratio(results, log.peer, log.target),
            Ratio("with one thread", tuple(theirs / ours for theirs, ours in one_thread), None),
        ),
    )
    growth = [memory.growth("columns", OURS, part, whole) for _ in range(turns)]
    columns = growth[0].columns
    shares = tuple(one.anonymous / columns for one in growth)
    yield Row(
        f"memory of a {log.suffix}, {columns / 1e6:.0f} MB of columns",
        {OURS: f"{statistics.median(one.anonymous for one in growth) / 1e6:.0f} MB"},
        (Ratio("times its columns", shares, 1.5, higher_is_better=False),),
    )
    yield memory.conversion(whole, bench.folder / "dataset")
    yield one_type(whole, log.one_type, turns)
    yield saved_index(whole, bench.folder / "cache", turns)


def one_type(path: Path, name: str, turns: int) -> Row:
    """Decode one table of an open log beside all tables; the processor time is compared."""
    log = mavstack.open_log(path)
    shares = []
    for _ in range(turns + 1):  # the first turn brings the file into memory
        every = _processor_time(log.load)
        log.clear_cache()
        one = _processor_time(partial(log.load, name))
        log.clear_cache()
        shares.append(one / every)
    ratio = Ratio("of all tables", tuple(shares[1:]), 0.1, higher_is_better=False)
    title = f"{name} alone of an indexed {path.suffix} of {path.stat().st_size / 1e6:.0f} MB"
    return Row(title, {OURS: f"{one * 1e3:.0f} ms"}, (ratio,))


def saved_index(path: Path, cache: Path, turns: int) -> Row:
    """Open a log with its saved index beside opening it without; the processor time is compared.

    Opening reads the totals of the index; its positions, a tenth of the log, are read with the first table.
    The log is in memory here.
    """
    shares, first_table = [], []
    # A quick run has smaller logs than those whose index is kept.
    with patch.dict(os.environ, {"XDG_CACHE_HOME": str(cache)}), patch.object(cached, "MIN_LOG", 0):
        os.utime(path, (0, 0))  # of a log that has just changed no index is kept
        for _ in range(turns + 1):  # the first turn saves it
            without = _processor_time(partial(_indexed, path))
            with patch.dict(os.environ, {"MAVSTACK_CACHE": "1"}):
                again = _processor_time(partial(_indexed, path))
                log = _indexed(path)
                table = _processor_time(partial(log.load, min(log.counts, key=log.counts.__getitem__)))
            shares.append(again / without)
            first_table.append((again + table) / without)
    ratios = (
        Ratio("of indexing it", tuple(shares[1:]), 0.1, higher_is_better=False),
        Ratio("with a first table", tuple(first_table[1:]), None, higher_is_better=False),
    )
    return Row(f"opening a {path.suffix} with its saved index", {OURS: f"{again * 1e3:.1f} ms"}, ratios)


def _indexed(path: Path) -> mavstack.Log:
    """Return an open log; some formats are indexed when their counts are first read."""
    log = mavstack.open_log(path)
    if not log.counts:
        raise RuntimeError(f"{path} is empty")
    return log


def _processor_time(work: Callable[[], object]) -> float:
    started = process_time()
    work()
    return process_time() - started


def _timed(
    count: Callable[[Mapping[str, Any]], int],
    read: Callable[[Path], Mapping[str, Any]],
    path: Path,
    records: int,
) -> float:
    """Return the seconds per record."""
    start = perf_counter()
    tables = read(path)
    seconds = perf_counter() - start
    if count(tables) != records:
        raise RuntimeError(f"{count(tables)} of {records} records were read")
    return seconds / records
