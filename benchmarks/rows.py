"""The rows of the table: the benchmarks, their amounts, and their targets.

A slow peer gets fewer messages than a fast one: all figures are per message, and every amount takes long
enough to be measured. `Amounts` are the amounts of a full and of a quick run.
"""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from . import memory, ours, peers_pymavlink
from .measure import MAVUTIL, OURS, PYMAVLINK, C, Ratio, Row, rates, speed_ratio, take_turns
from .onboard_logs import saved_index

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from .c_library import CProgram
    from .workload import Workload

CHUNK = 16384


@dataclass(frozen=True, slots=True)
class Amounts:
    """Number of messages of each side, number of turns, and sizes of tlogs in bytes.

    `log` is the number of messages of the flight. Our side decodes a tlog of `tlog_size`; one of `large_size`
    shows the cost of a single message.
    """

    log: int
    fast: int
    slow: int
    turns: int
    starts: int
    tlog_size: int
    large_size: int


FULL = Amounts(1_000_000, 500_000, 100_000, 11, 15, tlog_size=420_000_000, large_size=1_000_000_000)
QUICK = Amounts(1_000_000, 100_000, 20_000, 5, 7, tlog_size=40_000_000, large_size=80_000_000)


@dataclass(frozen=True, slots=True)
class Bench:
    """The common input of all rows."""

    flight: Workload
    program: CProgram | None
    amounts: Amounts
    folder: Path

    def file(self, name: str, content: Callable[[], bytes]) -> Path:
        """Write a file of the workload; return its path."""
        path = self.folder / name
        path.write_bytes(content())
        return path

    def tlog(self, size: int) -> tuple[Path, int]:
        """Write a tlog of at least a size; return its path and the number of its packets."""
        path = self.folder / "flight.tlog"
        return path, self.flight.write_tlog(path, size)

    def c(self, mode: str, count: int, file: Path | None = None) -> dict[str, Callable[[], float]]:
        """Return the runner of the C library, if it was built."""
        return {} if self.program is None else {C: partial(self.program.seconds, mode, count, file)}

    def compare(
        self, title: str, work: dict[str, Callable[[], float]], pymavlink: float | None, c: float | None
    ) -> Row:
        """Take turns, and compare the results."""
        results = take_turns(work, self.amounts.turns)
        targets = {PYMAVLINK: pymavlink, C: c}
        peers = [name for name in work if name != OURS]
        figures = {C: "-" if self.program else "not built"} | rates(results)
        return Row(title, figures, tuple(speed_ratio(results, peer, targets[peer]) for peer in peers))


def live(bench: Bench) -> Row:
    """Parse a live stream to typed messages, and read three fields of each."""
    many, few = bench.amounts.fast, bench.amounts.slow
    flight = bench.flight
    file = bench.file("flight.bin", lambda: flight.stream)
    work: dict[str, Callable[[], float]] = {
        PYMAVLINK: partial(peers_pymavlink.live, flight.chunks(CHUNK, few), few),
        **bench.c("live", many, file),
        OURS: partial(ours.live, flight.chunks(CHUNK, many), many),
    }
    return bench.compare("live stream to messages, three fields of each", work, 30, None)


def single(bench: Bench) -> Row:
    """Parse one packet per call to typed messages."""
    many, few = bench.amounts.fast // 2, bench.amounts.slow
    packets = bench.flight.packets(many)
    work: dict[str, Callable[[], float]] = {
        PYMAVLINK: partial(peers_pymavlink.single, packets[:few]),
        OURS: partial(ours.single, packets),
    }
    return bench.compare("one call per packet, three fields of each", work, 10, None)


def encode(bench: Bench) -> Row:
    """Encode fields to packets."""
    many = bench.amounts.fast
    values: list[tuple[Any, ...]] = [
        (index, *((index % 4096) * 0.0007 + 0.1 + offset for offset in range(6))) for index in range(many)
    ]
    work: dict[str, Callable[[], float]] = {
        PYMAVLINK: partial(peers_pymavlink.encode, values[: bench.amounts.slow]),
        **bench.c("encode", many * 4),
        OURS: partial(ours.encode, values),
    }
    return bench.compare("fields to packet (ATTITUDE)", work, 12, None)


def verify(bench: Bench) -> Row:
    """Verify signatures without creating messages."""
    many, few = bench.amounts.fast // 2, bench.amounts.slow
    packets = bench.flight.signed(many)
    stream = b"".join(packets)
    end = sum(map(len, packets[:few]))
    file = bench.file("signed.bin", lambda: stream)
    work: dict[str, Callable[[], float]] = {
        PYMAVLINK: partial(peers_pymavlink.verify, _cut(stream[:end]), few),
        **bench.c("signed", many, file),
        OURS: partial(ours.verify, _cut(stream), many),
    }
    return bench.compare("verify signed packets", work, None, 2)


def _cut(stream: bytes) -> list[bytes]:
    return [stream[at : at + CHUNK] for at in range(0, len(stream), CHUNK)]


def tlogs(bench: Bench) -> Iterator[Row]:
    """Decode a tlog of a usual size and a large one, and open the large one with its saved index."""
    for size in dict.fromkeys((QUICK.tlog_size, bench.amounts.tlog_size)):
        yield tlog(bench, size=size)
    whole, _ = bench.tlog(bench.amounts.tlog_size)
    yield saved_index(whole, bench.folder / "cache", bench.amounts.turns)


def tlog(bench: Bench, threads: int = 0, size: int = 0) -> Row:
    """Decode a tlog to columns: all messages and fields, by default on all cores."""
    fast, few = bench.amounts.fast, bench.amounts.slow
    whole, many = bench.tlog(size or bench.amounts.tlog_size)
    part = bench.file("part.tlog", partial(bench.flight.tlog, fast))
    slice_ = bench.file("slice.tlog", partial(bench.flight.tlog, few))
    _assert_equal(ours.columns(slice_, threads), peers_pymavlink.columns(slice_))
    work: dict[str, Callable[[], float]] = {
        PYMAVLINK: partial(peers_pymavlink.tlog, slice_, few),
        **bench.c("tlog", fast, part),
        OURS: partial(ours.tlog, whole, many, threads),
    }
    title = f"tlog of {whole.stat().st_size / 1e6:.0f} MB to columns"
    if threads:
        return bench.compare(f"{title} on one core", work, None, None)
    return bench.compare(f"{title}, CRC checked", work, 400, 4)


def _assert_equal(our_tables: dict[str, Any], peer_tables: dict[str, Any]) -> None:
    """Raise if both readers decode different columns."""
    if set(our_tables) != set(peer_tables):
        raise RuntimeError(f"tables differ: {sorted(set(our_tables) ^ set(peer_tables))}")
    for name, table in peer_tables.items():
        for field, column in table.items():
            if field != "_timestamp" and column.dtype.kind in "iuf":
                same = (our_tables[name][field].astype(column.dtype) == column).all()
                if not same:
                    raise RuntimeError(f"{name}.{field} differs")


def log_memory(bench: Bench) -> Row:
    """Compare the peak memory of decoding a log to the size of its columns."""
    few = bench.amounts.slow
    warm = bench.file("warm.tlog", partial(bench.flight.tlog, few // 10))
    slice_ = bench.file("slice.tlog", partial(bench.flight.tlog, few))
    whole, many = bench.tlog(bench.amounts.tlog_size)
    our_growth = [memory.growth("columns", OURS, warm, whole) for _ in range(bench.amounts.turns)]
    peer_growth = memory.growth("columns", PYMAVLINK, warm, slice_)
    streamed = memory.growth("stream", OURS, warm, whole)
    size = our_growth[0].columns
    figures = {
        OURS: f"{statistics.median(one.anonymous for one in our_growth) / 1e6:.0f} MB",
        PYMAVLINK: f"{peer_growth.anonymous * many / few / 1e6:.0f} MB",
    }
    return Row(
        f"memory of a log, {size / 1e6:.0f} MB of columns",
        figures,
        (
            Ratio(
                "times its columns",
                tuple(one.anonymous / size for one in our_growth),
                1.5,
                higher_is_better=False,
            ),
            Ratio("with the mapped file's pages", tuple(one.peak / size for one in our_growth), None),
            Ratio("streamed, no packets kept", (streamed.peak / size,), None),
        ),
    )


def first_message(bench: Bench) -> Iterator[Row]:
    """Compare time and memory of the import and the first message."""
    names = (PYMAVLINK, MAVUTIL, OURS)
    starts = take_turns({name: partial(memory.first_message, name) for name in names}, bench.amounts.starts)
    for index, title, unit, scale in ((0, "time", "ms", 1e3), (1, "memory", "MB", 1e-6)):
        values = {name: [result[index] for result in results] for name, results in starts.items()}
        figures = {
            name: f"{statistics.median(results) * scale:.1f} {unit}" for name, results in values.items()
        }
        shares = (_share(values, PYMAVLINK, 0.5), _share(values, MAVUTIL, None))
        yield Row(f"import and first message, {title}", figures, shares)


def _share(results: dict[str, list[float]], peer: str, target: float | None) -> Ratio:
    shares = tuple(own / peer_time for own, peer_time in zip(results[OURS], results[peer], strict=True))
    return Ratio(f"of {peer}", shares, target, higher_is_better=False)
