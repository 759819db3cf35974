"""S13: plan files that are made to exhaust memory: 64 MiB of `{}` took 1.6 GB."""

from __future__ import annotations

import subprocess
import sys

import pytest

resource = pytest.importorskip("resource")

#: Bytes of memory of the whole process while it reads 64 MiB; the text alone takes 64 MiB twice.
MAX_MEMORY = 500 << 20
PROGRAM = """
import resource, sys
from mavstack.errors import PlanFileError
from mavstack.files.plans import parse_plan
head, unit, tail = (part.encode() for part in sys.argv[1:])
size = 64 * 1024 * 1024 - len(head) - len(tail)
try:
    parse_plan(head + unit * (size // len(unit)) + tail)
except PlanFileError as error:
    print(error)
try:  # the peak since the program began; ru_maxrss begins with the memory of the process that started it
    print(next(line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM")))
except OSError:
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""
QGC = '{"fileType": "Plan", "version": 1, "groundStation": "x", "mission": ['
JSON = [
    ("objects", QGC, "{},", "{}]}"),
    ("arrays", QGC, "[],", "[]]}"),
    ("numbers", QGC, "1.5,", "1]}"),
    ("texts", QGC, '"ab",', '""]}'),
    ("keys", QGC + "{", '"ab":{},', '"a":1}]}'),
    ("own format", '{"fileType": "MavstackPlan", "version": 1, "mission": [', "{},", "{}]}"),
]
LINES = [
    ("waypoints", "QGC WPL 110\n", "0\t0\t0\t16\t0\t0\t0\t0\t1\t2\t3\t1\n", ""),
    ("fence", "", "1.0 2.0\n", ""),
    ("rally", "", "RALLY 1 2 3 4 5 6\n", ""),
    ("empty lines", "QGC WPL 110\n", "\n", ""),
]


def memory_for(*parts: str) -> tuple[str, int]:
    """Return the output of a process that reads such a file, and its memory in bytes."""
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM, *parts], capture_output=True, text=True, timeout=280, check=True
    )
    *problem, kibibytes = run.stdout.splitlines()
    scale = 1 if sys.platform == "darwin" else 1024
    return "\n".join(problem), int(kibibytes) * scale


def test_objects() -> None:
    _, *parts = JSON[0]
    problem, used = memory_for(*parts)
    assert "more values than any plan has" in problem
    assert used < MAX_MEMORY


@pytest.mark.nightly
@pytest.mark.parametrize("parts", [parts for _, *parts in JSON], ids=[name for name, *_ in JSON])
def test_json(parts: list[str]) -> None:
    problem, used = memory_for(*parts)
    assert "more values than any plan has" in problem
    assert used < MAX_MEMORY


@pytest.mark.nightly
@pytest.mark.parametrize("parts", [parts for _, *parts in LINES], ids=[name for name, *_ in LINES])
def test_lines(parts: list[str]) -> None:
    assert memory_for(*parts)[1] < MAX_MEMORY
