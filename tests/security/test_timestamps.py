"""The signing timestamp on disk."""

from __future__ import annotations

import os
import subprocess
import sys
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

import mavstack
from mavstack.dialects import common
from mavstack.errors import SigningError
from mavstack.security import SigningKey, TimestampStore, file_lock
from mavstack.security.timestamps import (
    MAX_RUNS,
    MAX_STREAMS,
    MAX_TIMESTAMP,
    RUN_TIMEOUT,
    LastRun,
    timestamp_at,
)


@pytest.fixture
def store(tmp_path):
    return TimestampStore(tmp_path / "clock")


def test_a_missing_file_reads_as_zero(store):
    assert store.load() == 0
    assert not store.path.exists()


def test_the_timestamp_only_increases(store):
    for timestamp, stored in (
        (5, 5),
        (3, 5),
        (5, 5),
        (6, 6),
        (0, 6),
        (MAX_TIMESTAMP, MAX_TIMESTAMP),
        (7, MAX_TIMESTAMP),
    ):
        store.store(timestamp)
        assert store.load() == TimestampStore(str(store.path)).load() == stored
    assert {path.name for path in store.path.parent.iterdir()} == {"clock", "clock.lock"}


@pytest.mark.parametrize(
    "damage",
    [
        b"",
        b"x",
        b"-1",
        b"1.5",
        b"12\n34",
        b"\xff",
        b"0" * 99,
        b"5\nrunning\nx",
        b"5\nrunning a\n",
        b"5\nrunning a -1\n",
        b"5\nfloor x\n",
        b"5\n1 2 3\n",
        b"5\nkey 1 2 256 4\n",
        b"5\nkey 1 2 3 -4\n",
        b"9" * 5000,
        b"281474976710656",
    ],
)
def test_a_damaged_file_raises_and_is_kept(store, damage):
    store.path.write_bytes(damage)
    for action in (store.load, lambda: store.store(5)):
        with pytest.raises(SigningError, match="clock"):
            action()
    assert store.path.read_bytes() == damage


@pytest.mark.parametrize("wrong", [-1, MAX_TIMESTAMP + 1])
def test_an_invalid_timestamp_is_not_stored(store, wrong):
    with pytest.raises(SigningError, match="48 bits"):
        store.store(wrong)
    assert store.load() == 0


def test_a_file_that_cannot_be_read_or_written_raises(tmp_path):
    with pytest.raises(SigningError):
        TimestampStore(tmp_path).load()
    with pytest.raises(SigningError, match="cannot write"):
        TimestampStore(tmp_path / "no" / "folder").store(5)


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_an_interrupted_write_leaves_the_old_value(store, monkeypatch, step):
    store.store(5)

    def fail(*_arguments):
        raise OSError("power cut")

    with monkeypatch.context() as patch:
        patch.setattr(os if step == "fsync" else type(store.path), step, fail)
        with pytest.raises(SigningError, match="power cut"):
            store.store(6)
    assert store.load() == 5
    store.store(7)
    assert store.load() == 7


def test_a_reader_never_sees_a_partial_value(store):
    store.store(1)
    values, finished = set(), threading.Event()

    def read():
        while not finished.is_set():
            values.add(store.load())

    reader = threading.Thread(target=read)
    reader.start()
    for number in range(2, 60):
        store.store(number * 10**12)
    finished.set()
    reader.join()
    assert values <= {1, *(number * 10**12 for number in range(2, 60))}


@pytest.mark.skipif(os.name != "posix", reason="permissions")
def test_others_may_read_the_timestamp_but_not_write_it(store):
    store.store(5)
    assert store.path.stat().st_mode & 0o022 == 0


def test_a_restarted_link_continues_after_the_stored_timestamp(store):
    now = 1_750_000_000.0
    first = mavstack.Signing(bytes(32), timestamp=store.load())
    mavstack.encode(common.Heartbeat(), system=1, component=1, signing=first, now=now)
    store.store(first.timestamp)
    # After the restart the system clock is an hour behind.
    second = mavstack.Signing(bytes(32), timestamp=store.load())
    raw = mavstack.encode(common.Heartbeat(), system=1, component=1, signing=second, now=now - 3600)
    assert int.from_bytes(raw[-12:-6], "little") == timestamp_at(now) + 1


@given(st.floats(0, 4e9))
def test_python_and_the_core_convert_times_alike(now):
    signing = mavstack.Signing(bytes(32))
    mavstack.encode(common.Heartbeat(), system=1, component=1, signing=signing, now=now)
    assert signing.timestamp == max(1, timestamp_at(now))


KEY, OTHER = SigningKey.from_passphrase("key"), SigningKey.from_passphrase("other")


def test_streams_are_kept_by_key_and_only_increase(store):
    store.store(5, [(KEY, {(1, 1, 1): 10, (2, 1, 1): 20}), (OTHER, {(1, 1, 1): 30})])
    store.store(4, [(KEY, {(1, 1, 1): 9, (2, 1, 1): 21})])
    last_run = TimestampStore(store.path).load_last_run()
    assert (last_run.timestamp, last_run.is_complete) == (5, True)
    assert last_run.streams_of(KEY) == {(1, 1, 1): 10, (2, 1, 1): 21}
    assert last_run.streams_of(OTHER) == {(1, 1, 1): 30}
    assert last_run.streams_of(SigningKey.generate()) == {}


def test_the_file_does_not_contain_the_key(store):
    store.store(5, [(KEY, {(1, 1, 1): 10})])
    assert KEY.secret_bytes().hex()[:8] not in store.path.read_text()


def test_a_run_that_did_not_end_is_noticed(store):
    assert not store.begin_run().is_complete, "there was no run"
    assert TimestampStore(store.path).load_last_run().running
    store.store(7, running=True)
    assert not store.load_last_run().is_complete
    store.store(7)
    assert store.load_last_run() == LastRun(7)
    assert store.begin_run().is_complete


def test_runs_of_two_processes_are_known_separately(store):
    other = TimestampStore(store.path)
    store.begin_run()
    assert not other.begin_run().is_complete, "the first still runs"
    store.store(7)
    assert not store.load_last_run().is_complete, "the other still runs"
    other.store(8)
    assert store.load_last_run() == LastRun(8)


def test_a_killed_run_is_forgotten_after_a_while(store):
    TimestampStore(store.path).begin_run()
    store.store(RUN_TIMEOUT - 1)
    assert not store.load_last_run().is_complete
    store.store(RUN_TIMEOUT)
    assert store.load_last_run().is_complete


def test_the_floor_is_kept_and_only_increases(store):
    for floor, stored in ((5, 5), (3, 5), (7, 7)):
        store.store(1, floor=floor)
        assert store.load_last_run() == LastRun(1, stored)
    with pytest.raises(SigningError, match="48 bits"):
        store.store(1, floor=MAX_TIMESTAMP + 1)


def test_a_run_that_begins_has_the_present_time(store):
    store.begin_run(10 * RUN_TIMEOUT)
    TimestampStore(store.path).store(10 * RUN_TIMEOUT + 1)
    assert list(store.load_last_run().running.values()) == [10 * RUN_TIMEOUT]


def test_a_run_that_begins_without_a_clock_has_the_stored_time(store):
    store.store(10 * RUN_TIMEOUT)
    store.begin_run()
    TimestampStore(store.path).store(10 * RUN_TIMEOUT + 1)
    assert list(store.load_last_run().running.values()) == [10 * RUN_TIMEOUT]


def test_runs_that_never_end_are_bounded(store):
    for number in range(MAX_RUNS + 9):
        TimestampStore(store.path).store(number, running=True)
    assert sorted(store.load_last_run().running.values()) == list(range(9, MAX_RUNS + 9))


SHARED = """
import sys
from mavstack.security import SigningKey, TimestampStore, file_lock

file_lock.LOCK_TIMEOUT = 60
key, own = SigningKey.from_passphrase("key"), int(sys.argv[2])
store = TimestampStore(sys.argv[1])
newest = 0
for number in range(20):
    streams = {(own, 1, 1): number + 1, (9, 1, 1): 2 * number + own}
    store.store(2 * number + own, [(key, streams)], running=True)
    last = store.load_last_run()
    assert last.timestamp >= newest, (last.timestamp, newest)
    assert last.streams_of(key)[own, 1, 1] == number + 1
    newest = last.timestamp
"""


def test_processes_that_share_a_file_lose_nothing_of_each_other(store):
    programs = [
        subprocess.Popen([sys.executable, "-c", SHARED, store.path, str(number)], stderr=subprocess.PIPE)
        for number in range(3)
    ]
    assert [program.communicate(timeout=60)[1].decode() for program in programs] == ["", "", ""]
    last = store.load_last_run()
    assert last.timestamp == 40
    assert last.streams_of(KEY) == {(0, 1, 1): 20, (1, 1, 1): 20, (2, 1, 1): 20, (9, 1, 1): 40}
    assert {path.name for path in store.path.parent.iterdir()} == {"clock", "clock.lock"}


def test_a_process_that_holds_the_lock_does_not_block_others_for_ever(store, monkeypatch):
    store.store(5)
    monkeypatch.setattr(file_lock, "LOCK_TIMEOUT", 0.01)
    with file_lock.locked(store.path), pytest.raises(SigningError, match="another process has locked it"):
        TimestampStore(store.path).store(6)
    store.store(6)
    assert store.load() == 6


@pytest.mark.parametrize(
    ("text", "expected"),
    [("123\n", LastRun(123)), ("5\nrunning\n", LastRun(5, running={"": 5}))],
)
def test_a_file_of_an_older_version_is_read(store, text, expected):
    store.path.write_text(text)
    assert store.load_last_run() == expected


def test_the_newest_streams_are_kept(store):
    streams = {(link, system, 1): 256 * system + link for link in range(256) for system in range(6)}
    store.store(5, [(KEY, streams)])
    kept = store.load_last_run().streams_of(KEY)
    assert len(kept) == MAX_STREAMS
    assert min(kept.values()) == len(streams) - MAX_STREAMS
