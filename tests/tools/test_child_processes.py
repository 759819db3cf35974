"""Children of benchmarks, tools and tests end with them, however these end."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.blocks import ROOT
from tests.waiting import wait_until
from tools.child_processes import VARIABLE

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no marks of descendants")

#: Starts a shell in its own session, which starts a program; prints their ids, and waits for the word to end.
#: Tests that run under nohup hand it an ignored SIGHUP.
PROGRAM = """
import signal, subprocess, sys
signal.signal(signal.SIGHUP, signal.SIG_DFL)
{start}
words = ["sh", "-c", "sleep 600 & echo $! $$; wait"]
child = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, start_new_session=True)
try:
    print(child.stdout.readline(), end="", flush=True)
    sys.stdin.readline()
finally:
    print("in order", flush=True)
"""
TOOL = "from tools.child_processes import *; end_children_with_this_process()"
TESTS = "from tools.child_processes import *; end_children_with_this_process(handle_signals=False)"


def runs(process: int) -> bool:
    """Return whether a process is there and is more than an entry that waits for its parent."""
    try:
        os.kill(process, 0)
    except OSError:
        return False
    status = Path(f"/proc/{process}/stat")
    return not status.exists() or status.read_text().rpartition(") ")[2][0] != "Z"


def ended(start: str, number: signal.Signals | None) -> tuple[str, list[int]]:
    """Run the program, and end it; return what it printed last, and the ids of its descendants."""
    environment = {key: value for key, value in os.environ.items() if key != VARIABLE}
    pipe = subprocess.PIPE
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM.format(start=start)],
        cwd=ROOT,
        env=environment,
        stdin=pipe,
        stdout=pipe,
        text=True,
    ) as program:
        assert program.stdout is not None
        descendants = [int(word) for word in program.stdout.readline().split()]
        assert all(map(runs, descendants))
        if number is None:
            output, _ = program.communicate("\n")
        else:
            program.send_signal(number)
            output = program.stdout.read()
    return output, descendants


async def none_runs(descendants: list[int]) -> None:
    await wait_until(lambda: not any(map(runs, descendants)), "the descendants end")


@pytest.mark.parametrize("number", [None, signal.SIGTERM, signal.SIGHUP], ids=str)
@pytest.mark.parametrize("start", [TOOL, "import benchmarks"], ids=["a tool", "a benchmark"])
async def test_descendants_end_with_an_orderly_end(start, number):
    output, descendants = ended(start, number)
    assert output == "in order\n"
    await none_runs(descendants)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL], ids=str)
@pytest.mark.parametrize("start", [TOOL, TESTS], ids=["a tool", "tests"])
async def test_descendants_end_also_after_an_end_without_order(start, number):
    await none_runs(ended(start, number)[1])


def test_these_tests_are_watched():
    assert VARIABLE in os.environ
