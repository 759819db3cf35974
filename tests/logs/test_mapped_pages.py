"""Pages of mapped files are given back, and can be read again."""

from __future__ import annotations

import mmap
from pathlib import Path

import pytest

from mavstack.logs.mapped_pages import release


def test_released_pages_are_read_again(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(bytes(range(256)) * 100)
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        for start, end in ((0, 25_600), (5000, 5001), (100, 100), (20_000, 25_600)):
            release(data, start, end)
            assert data[:] == path.read_bytes()
    release(b"bytes in memory", 0, 15)


@pytest.mark.skipif(not Path("/proc/self/smaps").exists(), reason="needs Linux")
def test_released_pages_need_no_memory(tmp_path):
    path = tmp_path / "mapped file"
    path.write_bytes(bytes(1 << 20))

    def resident():
        lines = iter(Path("/proc/self/smaps").read_text("utf-8").splitlines())
        found = next(line for line in lines if line.endswith(str(path)))
        return found and int(next(line for line in lines if line.startswith("Rss:")).split()[1])

    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        assert data[:] == bytes(1 << 20)
        before = resident()
        release(data, 0, 1 << 20)
        assert (before, resident()) == (1024, 0)
