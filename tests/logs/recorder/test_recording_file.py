"""Files of complete records."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.errors import LogError
from mavstack.logs.recorder.recording_file import RecordingFile

if TYPE_CHECKING:
    from pathlib import Path


def test_records_are_in_the_file_at_once(tmp_path: Path) -> None:
    path = tmp_path / "flight"
    file = RecordingFile(path, b"head")
    file.append(b"one")
    assert path.read_bytes() == b"headone"
    assert file.size == 7
    file.append(b"")
    file.close()
    file.close()


def test_a_closed_file_is_not_stored_again(tmp_path: Path) -> None:
    file = RecordingFile(tmp_path / "flight", b"")
    file.close()
    file.sync()


def test_a_disk_that_is_gone_is_one_error(tmp_path):
    file = RecordingFile(tmp_path / "a.tlog", b"")

    class Gone:
        def write(self, data):
            raise OSError(5, "Input/output error")

        truncate = seek = write

        def close(self):
            pass

    file.close()
    file._file = Gone()
    with pytest.raises(LogError, match="Input/output error; 0 bytes are kept"):
        file.append(b"record")
