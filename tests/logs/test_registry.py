"""Recognising a file imports no reader but that of its format."""

from __future__ import annotations

import subprocess
import sys

import pytest

from mavstack.dialects import common
from tests.logs.dataflash.writer import flight
from tests.logs.files import encoded, stamped
from tests.logs.ulog import ulog_files

READERS = {"dataflash", "packets", "ulog"}
PROGRAM = """
import sys
from mavstack import open_log
open_log(sys.argv[1])
print(*(name.split(".")[2] for name in sys.modules if name.startswith("mavstack.logs.")))
"""


@pytest.mark.parametrize(
    ("reader", "content"),
    [
        ("dataflash", lambda: bytes(flight(records=10).data)),
        ("ulog", lambda: ulog_files.flight(10)),
        ("packets", lambda: stamped(encoded([common.Attitude()] * 20))),
    ],
)
def test_only_the_reader_of_the_format_is_imported(tmp_path, reader, content):
    path = tmp_path / "flight"
    path.write_bytes(content())
    result = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(path)], check=True, capture_output=True, text=True
    )
    assert READERS & set(result.stdout.split()) == {reader}
