"""Logs are read in memory that does not grow with the file: no mapped pages, no positions of records."""

from __future__ import annotations

from pathlib import Path

import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.errors import LogError
from mavstack.logs import mapped_pages
from mavstack.logs.dataflash import dataflash_log
from mavstack.logs.export import export_log
from mavstack.logs.joined_windows import join_windows
from mavstack.logs.packets import packet_log
from mavstack.logs.ulog import entries, ulog
from tests.logs.conformance import column_bytes
from tests.logs.dataflash.writer import LogWriter
from tests.logs.files import encoded, stamped
from tests.logs.ulog import ulog_files

STEP = 1 << 18
SIZE = 3 << 20
needs_linux = pytest.mark.skipif(not Path("/proc/self/smaps").exists(), reason="needs Linux")


def tlog():
    packets = stamped(encoded([common.Attitude(number) for number in range(1000)]))
    return packets * (SIZE // len(packets))


def dataflash():
    log = LogWriter()
    for second in range(1, 10):
        log.write("MSG", second * 1_000_000, "text")
    definitions, second = bytes(log.data), len(log.data)
    for number in range(1000):
        log.write("IMU", 10_000_000 + number * 1000, 0, *[1.0] * 6)
        log.write("ATT", 10_000_000 + number * 1000, *[100] * 6)
        if number % 100 == 0:
            log.gps(10_000_000 + number * 1000, 1_700_000_000_000_000)
    cycle = bytes(log.data[second:])
    return definitions + cycle * (SIZE // len(cycle))


def px4():
    builder = ulog_files.definitions()
    before = len(builder.data)
    ulog_files.add_samples(builder, 500)
    cycle = bytes(builder.data[before:])
    return bytes(builder.data[:before]) + cycle * (SIZE // len(cycle))


def resident(path):
    """Return the kilobytes of a mapped file in memory; 0 if it is not mapped."""
    lines = iter(Path("/proc/self/smaps").read_text("utf-8").splitlines())
    if not any(line.endswith(str(path)) for line in lines):
        return 0
    return int(next(line for line in lines if line.startswith("Rss:")).split()[1])


@pytest.fixture(params=[tlog, dataflash, px4])
def path(request, tmp_path, monkeypatch):
    for module in (mapped_pages, dataflash_log, ulog, entries):
        monkeypatch.setattr(module, "STEP", STEP)
    monkeypatch.setattr(packet_log, "MAX_EAGER_SIZE", 1000)
    path = tmp_path / "long flight"
    path.write_bytes(request.param())
    return path


@needs_linux
@pytest.mark.parametrize("to", ["parquet", "arrow"])
def test_an_export_keeps_no_pages_of_the_file(path, tmp_path, monkeypatch, to):
    monkeypatch.setattr("mavstack.logs.export.writer._WINDOW", STEP)
    log, pages = open_log(path), []
    names = [name for name in ("ATTITUDE", "ATT", "vehicle_attitude", "attitude") if name in log]
    summary = export_log(
        log, to, tmp_path / "out", names=names, progress=lambda *_: pages.append(resident(path))
    )
    assert summary.rows == {name: log.counts[name] for name in names}
    assert len(pages) > 4
    assert max(pages) <= 3 * STEP >> 10, "kilobytes of a file with 3 MB"
    assert resident(path) <= 3 * STEP >> 10


def test_tables_are_the_same_after_an_export(path):
    log, other = open_log(path), open_log(path)
    log.prepare_windows()
    assert log.counts == other.counts
    assert (log.time_span, log.skipped, log.texts, log.info) == (
        other.time_span,
        other.skipped,
        other.texts,
        other.info,
    )
    for name, table in other.items():
        assert column_bytes(log[name]) == column_bytes(table)
        assert log[name].schema == table.schema
        assert log[name].flags.writeable
    log.load()


@needs_linux
def test_a_table_read_after_an_export_keeps_no_pages(path):
    log = open_log(path)
    log.prepare_windows()
    log.load()
    assert resident(path) <= 2 * STEP >> 10


def test_windows_with_other_rows_are_those_of_another_file(path):
    log = open_log(path)
    name, table = next((name, table) for name, table in log.items() if len(table) > 1)
    count = {name: len(table)}
    assert column_bytes(join_windows(path, count, [{name: table[:1]}, {name: table[1:]}])[name])
    for windows in ([{name: table[1:]}], [{name: table}, {name: table[:1]}]):
        with pytest.raises(LogError, match="rewritten since it was opened"):
            join_windows(path, count, windows)
