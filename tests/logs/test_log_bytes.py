"""The bytes of a log file: mapped under a lease, or copied, and never read beyond the end of the file."""

from __future__ import annotations

import mmap
import os
import sys
import tempfile
from pathlib import Path

import pytest

from mavstack.errors import LogError
from mavstack.logs import log_bytes
from mavstack.logs.log_bytes import LogBytes

pytestmark = pytest.mark.skipif(os.name != "posix", reason="Windows refuses to truncate a mapped file")


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"packets" * 1000)
    return path


def descriptors():
    return len(list(Path("/dev/fd").iterdir()))


@pytest.mark.skipif(sys.platform != "linux", reason="leases are a service of Linux")
def test_a_file_that_no_process_writes_is_mapped(path):
    source = LogBytes(path)
    with source.access() as data:
        assert isinstance(data, mmap.mmap)
        assert data[:7] == b"packets"
    with source.access() as again:
        assert again is data
    assert source.size == 7000


def test_a_file_that_is_open_for_writing_is_copied(path):
    with path.open("r+b") as writer:
        source = LogBytes(path)
        with source.access() as data:
            assert data == b"packets" * 1000
        writer.truncate(0)
        with source.access() as again:
            assert again is data


@pytest.mark.parametrize("leased", [True, False])
def test_a_large_file_without_a_lease_is_copied_to_a_file_without_a_name(path, tmp_path, monkeypatch, leased):
    monkeypatch.setattr(log_bytes, "_MAX_MEMORY", 1000)
    monkeypatch.setattr(log_bytes, "_READ_SIZE", 512)
    if leased:
        monkeypatch.setattr(log_bytes, "_MAX_LEASED_SIZE", 1000)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with path.open("r+b" if not leased else "rb") as other:
        source = LogBytes(path)
        with source.access() as data:
            assert isinstance(data, mmap.mmap)
        assert list(tmp_path.iterdir()) == [path]
        if not leased:
            other.truncate(0)
        source.release()
        with source.access() as again:
            assert again is data
            assert again[:] == b"packets" * 1000


def test_a_copy_that_finds_no_room_is_reported(path, tmp_path, monkeypatch):
    monkeypatch.setattr(log_bytes, "_MAX_MEMORY", 1000)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "missing"))
    with path.open("r+b"), pytest.raises(LogError, match=r"cannot be copied to .*missing: No such file"):
        LogBytes(path).access().__enter__()


def test_a_truncated_file_raises(path):
    source = LogBytes(path)
    with source.access():
        pass
    os.truncate(path, 100)
    for _ in range(2):
        with pytest.raises(LogError, match="truncated since it was opened; open it again"), source.access():
            pass
    path.write_bytes(b"packets" * 1000)
    with source.access() as data:
        assert len(data) == 7000


def test_a_truncated_file_that_is_open_for_writing_raises(path):
    source = LogBytes(path)
    with path.open("r+b") as writer:
        writer.truncate(100)
        with pytest.raises(LogError, match="truncated since"), source.access():
            pass


def test_an_empty_file_has_no_bytes(tmp_path):
    path = tmp_path / "empty.tlog"
    path.touch()
    with LogBytes(path).access() as data:
        assert data == b""


@pytest.mark.timeout(10)
def test_a_fifo_or_a_device_is_refused(tmp_path):
    path = tmp_path / "fifo.tlog"
    os.mkfifo(path)
    for name in (path, "/dev/zero", tmp_path):
        with pytest.raises(LogError, match="not a regular file"):
            LogBytes(name)


def test_no_descriptor_is_left_open(path):
    before = descriptors()
    for _ in range(3):
        with LogBytes(path).access():
            pass
    with pytest.raises(LogError):
        LogBytes(path.parent)
    assert descriptors() == before
