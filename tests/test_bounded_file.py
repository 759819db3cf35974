"""Files that are read up to a maximum size: FIFOs do not block, pipes are read to their end."""

from __future__ import annotations

import os
import threading
import time

import pytest

from mavstack.bounded_file import read_file_bounded
from mavstack.dialects import Dialect
from mavstack.errors import DialectError, ParameterFileError, PlanFileError, SigningError
from mavstack.files.parameters import read_parameters
from mavstack.files.plans import read_plan
from mavstack.security import SigningKey

needs_fifos = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs FIFOs")


@pytest.fixture
def fifo(tmp_path):
    path = tmp_path / "fifo.xml"
    os.mkfifo(path)
    return path


def test_a_file_is_read_up_to_the_maximum(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"0123456789")
    assert read_file_bounded(path, 4) == b"0123"
    assert read_file_bounded(str(path), 100) == b"0123456789"
    with pytest.raises(OSError, match="missing"):
        read_file_bounded(tmp_path / "missing", 4)
    with pytest.raises(IsADirectoryError):
        read_file_bounded(tmp_path, 4)


@needs_fifos
@pytest.mark.timeout(10)
def test_a_fifo_without_a_writer_is_empty(fifo):
    assert read_file_bounded(fifo, 4) == b""


@needs_fifos
@pytest.mark.timeout(10)
@pytest.mark.parametrize(
    ("read", "error"),
    [
        (Dialect.from_xml, DialectError),
        (read_plan, PlanFileError),
        (read_parameters, ParameterFileError),
        (SigningKey.load, SigningError),
    ],
)
def test_a_fifo_given_as_a_file_does_not_hang(fifo, read, error):
    try:
        content = read(fifo)
    except error:
        return
    assert len(content) == 0


@needs_fifos
@pytest.mark.timeout(10)
def test_a_pipe_with_a_writer_is_read_to_its_end(fifo):
    """Process substitution of a shell, `<(command)`, is a pipe whose writer may be slow."""
    reader, writer = os.pipe()

    def write() -> None:
        for _ in range(3):
            time.sleep(0.05)
            os.write(writer, b"piece")
        os.close(writer)

    thread = threading.Thread(target=write)
    thread.start()
    assert read_file_bounded(f"/dev/fd/{reader}", 100) == b"piece" * 3
    thread.join()
    os.close(reader)
