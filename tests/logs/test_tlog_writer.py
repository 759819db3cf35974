"""Recordings that survive a crash."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.errors import LogError
from mavstack.logs.tlog_writer import TlogWriter
from mavstack.wire import Packet, encode
from tests.cli.conftest import setup_signing

if TYPE_CHECKING:
    from pathlib import Path

TIME = 1_700_000_000.5


def packet(number: int = 0) -> Packet:
    return Packet(encode(common.Attitude(time_boot_ms=number), system=1, component=1), common)


def test_a_recording_can_be_read_while_it_is_written(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    with TlogWriter(path) as writer:
        writer.write([packet(1), packet(2)], TIME)
        table = open_log(path)["ATTITUDE"]
        assert list(table["time_boot_ms"]) == [1, 2]
        assert path.read_bytes()[:8] == int(TIME * 1e6).to_bytes(8, "big")
        writer.sync()
        assert writer.packets == 2
    writer.sync()
    writer.close()


def test_the_times_of_several_links_are_in_order(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    with TlogWriter(path) as writer:
        for offset in (0.0, -0.25, 0.5, -3600.0):
            writer.write([packet()], TIME + offset)
    times = open_log(path)["ATTITUDE"]["_time"]
    offsets = [(time - times[0]).astype("timedelta64[ms]").astype(int) for time in times]
    assert offsets == [0, 0, 500, -3_600_000]


def test_an_existing_file_is_never_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"precious")
    with pytest.raises(LogError, match="never overwrites a file"):
        TlogWriter(path)
    assert path.read_bytes() == b"precious"
    with pytest.raises(LogError, match="No such file or directory"):
        TlogWriter(tmp_path / "none" / "flight.tlog")


def test_secrets_are_blanked(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    with TlogWriter(path) as writer:
        writer.write([Packet(setup_signing(), common)], TIME)
    assert bytes(range(100, 108)) not in path.read_bytes()
    assert list(open_log(path)) == ["SETUP_SIGNING"]


def test_a_full_disk_leaves_complete_records(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    writer = TlogWriter(path)
    writer.write([packet(1)], TIME)
    complete = path.read_bytes()

    class FullDisk:
        """A file with room for five more bytes."""

        def __init__(self, file) -> None:
            self.file = file

        def write(self, data: bytes) -> int:
            return self.file.write(data[:5])

        def __getattr__(self, name: str):
            return getattr(self.file, name)

    writer._file = FullDisk(writer._file)
    with pytest.raises(LogError, match="1 packets are kept"):
        writer.write([packet(2)], TIME)
    assert path.read_bytes() == complete
    writer.close()


def test_an_error_of_the_disk_is_told(tmp_path: Path) -> None:
    writer = TlogWriter(tmp_path / "flight.tlog")

    class BrokenDisk:
        def write(self, data: bytes) -> int:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        def truncate(self, size: int) -> None: ...
        def seek(self, size: int) -> None: ...

    file, writer._file = writer._file, BrokenDisk()
    with pytest.raises(LogError, match="No space left on device"):
        writer.write([packet()], TIME)
    file.close()


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
def test_a_killed_program_leaves_complete_records(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    program = f"""
import os
from mavstack.dialects import common
from mavstack.logs.tlog_writer import TlogWriter
from mavstack.wire import Packet, encode
writer = TlogWriter({str(path)!r})
packet = Packet(encode(common.Attitude(), system=1, component=1), common)
for _ in range(100):
    writer.write([packet] * 3, 1.7e9)
os.kill(os.getpid(), {int(signal.SIGKILL)})
"""
    ended = subprocess.run([sys.executable, "-c", program], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert len(open_log(path)["ATTITUDE"]) == 300
