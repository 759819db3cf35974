from __future__ import annotations

import os
import time

import numpy as np
import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.logs import saved_index
from mavstack.logs.dataflash import DataFlashLog
from mavstack.logs.packets import PacketLog
from mavstack.logs.ulog import ULog
from tests.logs.dataflash.writer import LogWriter
from tests.logs.files import encoded, stamped
from tests.logs.ulog.ulog_files import UlogBuilder

OLD = time.time() - 100


def tlog():
    packets = [common.Heartbeat(), *(common.Attitude(number, number / 8) for number in range(50))]
    return b"junk" + stamped(encoded(packets))


def dataflash():
    log = LogWriter()
    for number in range(50):
        log.write("PARM", 1000 * number, f"P{number}", 1.0, 1.0)
    return log.data + b"junk"


def ulog():
    builder = UlogBuilder()
    builder.formats("t:uint64_t timestamp;float x;")
    builder.subscribe(0, "t")
    for number in range(50):
        builder.record(0, "Qf", number, 0.5)
    return builder.data


FORMATS = pytest.mark.parametrize(
    ("content", "kind"), [(tlog, PacketLog), (dataflash, DataFlashLog), (ulog, ULog)]
)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(saved_index, "cache_directory", lambda: tmp_path / "cache" / "mavstack")
    monkeypatch.setattr(saved_index, "MIN_LOG", 0)
    return tmp_path / "cache" / "mavstack" / "indexes"


def write(path, data, modified=OLD):
    path.write_bytes(data)
    os.utime(path, (modified, modified))
    return path


def content_of(log):
    tables = {name: [table[field].tobytes() for field in table.dtype.names] for name, table in log.items()}
    return tables, log.counts, log.skipped.to_dict(), log.time_span, log.parameters


@FORMATS
def test_an_index_is_used_again(tmp_path, folder, monkeypatch, content, kind):
    path = write(tmp_path / "log", content())
    first = content_of(open_log(path))
    assert len(list(folder.iterdir())) == 1
    monkeypatch.setattr(kind, "_indexed", lambda *_, **__: pytest.fail("the log was indexed again"))
    assert content_of(open_log(path)) == first


@FORMATS
def test_opening_reads_the_totals_alone(tmp_path, folder, monkeypatch, content, kind):
    path = write(tmp_path / "log", content())
    first = content_of(open_log(path))
    parts = []
    read = saved_index._read
    monkeypatch.setattr(saved_index, "_read", lambda *names: parts.append(names[2]) or read(*names))
    log = open_log(path)
    assert (log.counts, log.skipped.to_dict()) == (first[1], first[2])
    assert parts == ["totals"]
    assert content_of(log) == first
    assert parts == ["totals", "positions"], "they are read once"


@FORMATS
def test_positions_that_are_damaged_are_found_again(tmp_path, folder, content, kind):
    path = write(tmp_path / "log", content())
    first = content_of(open_log(path))
    (index,) = folder.iterdir()
    sound = index.read_bytes()
    index.write_bytes(sound[:-1] + bytes([sound[-1] ^ 1]))
    log = open_log(path)
    assert log.counts == first[1]
    assert content_of(log) == first
    assert index.read_bytes() == sound


@FORMATS
def test_a_changed_log_is_indexed_again(tmp_path, folder, content, kind):
    path = write(tmp_path / "log", content())
    before = content_of(open_log(path))
    changed = write(path, content() + content()[-40:], OLD + 10)
    assert len(list(folder.iterdir())) == 1
    assert content_of(open_log(changed)) != before
    assert len(list(folder.iterdir())) == 1


@FORMATS
def test_damaged_indexes_are_not_used(tmp_path, folder, content, kind):
    path = write(tmp_path / "log", content())
    expected = content_of(open_log(path))
    (index,) = folder.iterdir()
    sound = index.read_bytes()
    for damaged in (b"", sound[:-1], sound[:50], sound[:-1] + bytes([sound[-1] ^ 1]), sound + b"x"):
        index.write_bytes(damaged)
        assert content_of(open_log(path)) == expected
        assert index.read_bytes() == sound


@FORMATS
def test_the_core_refuses_bytes_that_are_no_index(tmp_path, folder, monkeypatch, content, kind):
    path = write(tmp_path / "log", content())
    expected = content_of(open_log(path))
    monkeypatch.setattr(saved_index, "_read", lambda *_: np.arange(40, dtype="<u8").tobytes())
    assert content_of(open_log(path)) == expected


def test_another_dialect_has_an_index_of_its_own(tmp_path, folder):
    path = write(tmp_path / "log", tlog())
    assert open_log(path, "common").counts == {**open_log(path, "minimal").counts, "ATTITUDE": 50}
    assert len(list(folder.iterdir())) == 2


def test_no_index_is_kept_when_it_is_turned_off_or_the_log_is_small_or_new(tmp_path, folder, monkeypatch):
    open_log(write(tmp_path / "new", tlog(), time.time()))
    path = write(tmp_path / "log", tlog())
    monkeypatch.setattr(saved_index, "MIN_LOG", path.stat().st_size + 1)
    open_log(path)
    monkeypatch.setattr(saved_index, "MIN_LOG", 0)
    monkeypatch.setenv("MAVSTACK_CACHE", "0")
    open_log(path)
    assert not folder.exists() or not list(folder.iterdir())


def test_a_folder_that_cannot_be_used_is_no_error(tmp_path, folder):
    path = write(tmp_path / "log", tlog())
    (tmp_path / "cache").write_bytes(b"")
    assert open_log(path).counts["ATTITUDE"] == 50
    assert (tmp_path / "cache").read_bytes() == b""


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="permissions of Unix")
def test_a_folder_that_others_may_write_is_not_used(tmp_path, folder):
    path = write(tmp_path / "log", tlog())
    open_log(path)
    (index,) = folder.iterdir()
    assert (folder.stat().st_mode & 0o777, index.stat().st_mode & 0o777) == (0o700, 0o600)
    index.unlink()
    folder.chmod(0o777)
    open_log(path)
    assert not list(folder.iterdir())


def test_the_oldest_indexes_make_room(tmp_path, folder, monkeypatch):
    paths = [write(tmp_path / f"log{number}", tlog()) for number in range(3)]
    open_log(paths[0])
    size = next(folder.iterdir()).stat().st_size
    os.utime(next(folder.iterdir()), (OLD, OLD))
    write(folder / ".1.part", b"", OLD - 4000)
    monkeypatch.setattr(saved_index, "MAX_TOTAL", int(2.5 * size))
    oldest = next(path for path in folder.iterdir() if path.suffix == ".index")
    for path in paths[1:]:
        open_log(path)
    names = sorted(path.name for path in folder.iterdir())
    assert len(names) == 2
    assert oldest.name not in names
    monkeypatch.setattr(saved_index, "MAX_INDEX", size - 1)
    oldest.unlink(missing_ok=True)
    open_log(paths[0])
    assert sorted(path.name for path in folder.iterdir()) == names
