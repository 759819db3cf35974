"""Logs of packets read piece by piece: without an index, without a copy of the file, wherever it is cut."""

from __future__ import annotations

import os
import tracemalloc

import numpy as np
import pytest

import mavstack
from mavstack.dialects import common
from mavstack.errors import LogError
from mavstack.logs.packets import packet_log
from tests.logs.conformance import column_bytes
from tests.logs.files import encoded, stamped

PACKETS = encoded([common.Attitude(number) for number in range(300)])
DAMAGED = stamped(PACKETS[:100]) + b"\xfd junk \xfe" * 9 + stamped(PACKETS[100:200]) + PACKETS[200][:-3]


@pytest.fixture
def path(tmp_path, monkeypatch):
    monkeypatch.setattr(packet_log, "MAX_EAGER_SIZE", 100)
    path = tmp_path / "flight"
    path.write_bytes(DAMAGED)
    return path


def joined(log, size, name="ATTITUDE"):
    return np.concatenate([window[name] for window in log.windows(size) if name in window])


@pytest.mark.parametrize("size", [1, 7, 37, 280, 999, 100_000])
def test_damage_at_a_cut_changes_nothing(path, size):
    log, whole = mavstack.open_log(path), mavstack.open_log(path)
    assert column_bytes(joined(log, size)) == column_bytes(whole["ATTITUDE"])
    assert log._index is None, "neither windows nor their totals need an index"
    assert log.counts == whole.counts == {"ATTITUDE": 200}
    assert log.skipped == whole.skipped
    assert log.skipped.bad_bytes > 0
    assert (log.statistics, log.sources, log.time_span) == (whole.statistics, whole.sources, whole.time_span)
    assert log._index is None


def test_a_large_file_is_indexed_when_a_table_is_needed(path):
    log = mavstack.open_log(path)
    assert log._index is None
    assert log["ATTITUDE"]["time_boot_ms"].tolist() == list(range(200))
    assert log._index is not None


@pytest.mark.skipif(os.name != "posix", reason="Windows refuses to truncate an open file")
def test_a_file_that_is_being_written_is_not_copied(path):
    with path.open("r+b") as writer:
        log = mavstack.open_log(path)
        assert len(joined(log, 1000)) == 200
        assert log._bytes._copy is None
        writer.truncate(500)
        with pytest.raises(LogError, match="truncated since it was opened"):
            list(log.windows(1000))


def test_an_abandoned_pass_leaves_no_totals(path):
    log = mavstack.open_log(path)
    next(log.windows(100))
    assert log.counts == {"ATTITUDE": 200}


def test_memory_is_that_of_a_window_not_of_the_file(path):
    path.write_bytes(stamped(PACKETS) * 300)
    log, size = mavstack.open_log(path), 32 << 10
    list(log.windows(size))  # what is imported and cached once
    tracemalloc.start()
    try:
        rows = sum(len(window["ATTITUDE"]) for window in log.windows(size))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert rows == 90_000
    assert peak < 8 * size < log.size / 6


def test_views_of_a_large_file_need_no_index(path):
    log = mavstack.open_log(path)
    view = log.select(system=1)
    assert len(joined(view, 500)) == 200
    assert log._index is None
