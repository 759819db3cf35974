"""Attack: another process truncates a log file while a program reads it, which must never end the program."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time

import pytest

from mavstack.dialects import common
from tests.logs.files import encoded, stamped

pytestmark = pytest.mark.skipif(os.name != "posix", reason="Windows refuses to truncate a mapped file")

#: Opens the file and decodes all its tables until the end of standard input.
READER = """
import select, sys
import mavstack
read = refused = 0
print("ready", flush=True)
while not select.select([sys.stdin], [], [], 0)[0]:
    try:
        log = mavstack.open_log(sys.argv[1], "common", timestamped=True, threads=2)
        log.load()
        read += 1
    except mavstack.LogError:
        refused += 1
print(read, refused)
"""


@pytest.fixture
def content():
    return stamped(encoded([common.Attitude(number) for number in range(256)])) * 800


@pytest.mark.parametrize("opened_before", [False, True])
def test_truncation_during_a_read_never_ends_the_process(tmp_path, content, opened_before):
    """Truncate by path, or through a descriptor that was opened for writing before the log."""
    path = tmp_path / "flight.tlog"
    path.write_bytes(content)
    rng = random.Random(11)
    with (
        path.open("r+b", buffering=0) as writer,
        subprocess.Popen(
            [sys.executable, "-c", READER, path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        ) as reader,
    ):
        if not opened_before:
            writer.close()
        assert reader.stdout.readline() == "ready\n"
        for _ in range(40):
            time.sleep(rng.random() * 0.04)
            length = rng.choice([0, 100, 4096, len(content) // 2])
            if opened_before:
                writer.truncate(length)
                writer.seek(0)
                writer.write(content)
            else:
                os.truncate(path, length)
                path.write_bytes(content)
            if reader.poll() is not None:
                break
        answer, _ = reader.communicate("")
    assert reader.returncode == 0, f"the reader ended with {reader.returncode}"
    read, refused = map(int, answer.split())
    assert read + refused > 0
