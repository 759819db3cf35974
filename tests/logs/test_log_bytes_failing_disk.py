"""A disk that fails under a mapped log: the process lives, and the log raises one typed error.

A file that is truncated under its map raises the same signal (SIGBUS) as a disk that fails. A lease prevents
the truncation, so the child processes claim a lease that they do not have.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.skipif(os.name != "posix", reason="Windows refuses to truncate a mapped file")

_HEAD = """
import mmap, os, sys
from pathlib import Path
from mavstack.errors import LogError
from mavstack.logs import log_bytes
log_bytes._take_lease = lambda descriptor: True
log_bytes._release_lease = lambda descriptor: None
path = Path(sys.argv[1])
"""
_READ = """
source = log_bytes.LogBytes(path)
try:
    with source.access() as data:
        os.truncate(path, mmap.PAGESIZE)
        print(data[0], data[-1], data[0])
        raise ValueError("the zeros are no log")
except LogError as error:
    print(error)
path.write_bytes(b"a" * 100_000)
with source.access() as data:
    print(data[-1])
"""
_OPEN = """
from mavstack.logs import open_log, saved_index
from mavstack.logs.saved_index import SavedIndex
saved_index.MIN_LOG = 1
build = SavedIndex._new
def fail(saved, data):
    os.truncate(path, mmap.PAGESIZE)
    return build(saved, data)
SavedIndex._new = fail
try:
    open_log(path)
except LogError as error:
    print(error)
"""
_FOREIGN = """
source = log_bytes.LogBytes(path)
with source.access():
    pass
data = mmap.mmap(os.open(path, os.O_RDONLY), 0, access=mmap.ACCESS_READ)
os.truncate(path, mmap.PAGESIZE)
data[-1]
"""


def run(script: str, path: Path, *options: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "XDG_CACHE_HOME": str(path.parent / "cache")}
    command = [sys.executable, *options, "-c", _HEAD + script, str(path)]
    return subprocess.run(command, capture_output=True, text=True, env=environment, timeout=100, check=False)


def reason(path: Path) -> str:
    return (
        f"cannot read {path}: the disk failed or the file was truncated while it was read; "
        "copy the file to another disk and open the copy"
    )


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"a" * 100_000)
    return path


def test_bytes_that_cannot_be_read_are_an_error_and_not_the_end_of_the_process(path: Path) -> None:
    done = run(_READ, path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines() == ["97 0 0", reason(path), "97"]


@pytest.mark.parametrize("name", ["flight.tlog", "flight.BIN", "flight.ulg"])
def test_a_log_whose_disk_fails_while_it_is_indexed_is_an_error(tmp_path: Path, name: str) -> None:
    heads = {
        "flight.tlog": b"",
        "flight.BIN": b"\xa3\x95\x80\x80\x59FMT\0BBnNZ\0" + bytes(75),
        "flight.ulg": b"ULog\x01\x12\x35\x01" + bytes(8),
    }
    path = tmp_path / name
    path.write_bytes(heads[name] + bytes(1 << 21))
    os.utime(path, (1e9, 1e9))
    done = run(_OPEN, path)
    assert (done.returncode, done.stderr, done.stdout.strip()) == (0, "", reason(path))
    assert not (tmp_path / "cache").exists()


@pytest.mark.parametrize("options", [(), ("-X", "faulthandler")])
def test_other_mappings_keep_their_signal(path: Path, options: tuple[str, ...]) -> None:
    done = run(_FOREIGN, path, *options)
    assert done.returncode == -signal.SIGBUS
    assert ("Fatal Python error: Bus error" in done.stderr) == bool(options)
