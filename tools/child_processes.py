"""Children end with the program that started them, however it ends.

    end_children_with_this_process()      # once, at the start of a program

Benchmarks and tests start vehicles, routers and other people's programs, some in sessions of their own, some
through others. One that stays would answer on its port for hours, like a vehicle of today. Therefore all
descendants carry a mark in their environment, and a watcher, a small process beside the program, ends those
with the mark when the program is gone, also after `kill -9`. A nested program leaves this to the outermost.

The watcher reads the environments of processes from `/proc`, or from `ps` where there is none. Windows has
neither: programs end their children there only as they end in order.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from types import FrameType

#: The mark: process id and start time of the outermost program.
VARIABLE: Final = "MAVSTACK_CHILD_OF"
#: Seconds between two looks at whether the program is gone, in case that a child keeps its pipe open.
_INTERVAL: Final = 1.0
#: Seconds that a child has for its own end.
_GRACE: Final = 2.0


def end_children_with_this_process(*, handle_signals: bool = True) -> None:
    """Have all descendants end when this process ends.

    Args:
        handle_signals: Whether SIGTERM and SIGHUP become an orderly end, by SystemExit. A program that runs
            code which catches it, as pytest does, leaves them as they are.
    """
    if VARIABLE in os.environ or os.name == "nt":
        return
    _start_watcher()
    for number in (signal.SIGTERM, signal.SIGHUP) if handle_signals else ():
        # One that is ignored, as SIGHUP by nohup, stays so.
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _end)


def _start_watcher() -> None:
    import subprocess

    mark = f"{os.getpid()}.{time.time_ns()}"
    # This process keeps the other end of the pipe, which closes with it.
    pipe, _ = os.pipe()
    watcher = subprocess.Popen(  # noqa: S603 (this module)
        [sys.executable, "-S", "-E", __file__, mark],
        stdin=pipe,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # keeps signals to the group from it
    )
    watcher.returncode = 0  # it outlives this process by design, and no warning shall say so
    os.close(pipe)
    os.environ[VARIABLE] = mark


def _end(number: int, _frame: FrameType | None) -> None:
    sys.exit(128 + number)


def _watch(mark: str) -> None:
    """Wait until the program is gone, then end its descendants."""
    parent = os.getppid()
    while os.getppid() == parent and not select.select([0], [], [], _INTERVAL)[0]:
        pass
    _signal_all(mark, signal.SIGTERM)
    end = time.monotonic() + _GRACE
    while _marked(mark) and time.monotonic() < end:
        time.sleep(0.05)
    # Repeated, since a process may start another one meanwhile.
    while _marked(mark) and time.monotonic() < end + _GRACE:
        _signal_all(mark, signal.SIGKILL)
        time.sleep(0.05)


def _signal_all(mark: str, number: signal.Signals) -> None:
    for process in _marked(mark):
        with contextlib.suppress(OSError):
            os.kill(process, number)


def _marked(mark: str) -> list[int]:
    """Return the ids of the processes that carry a mark."""
    wanted = f"{VARIABLE}={mark}"
    if not Path("/proc/self/environ").exists():
        return _marked_by_ps(wanted)
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if wanted.encode() in (folder / "environ").read_bytes().split(b"\0"):
                found.append(int(folder.name))
    return found


def _marked_by_ps(wanted: str) -> list[int]:
    import subprocess

    command = ["ps", "-axEww", "-o", "pid=,command="]
    lines = subprocess.run(command, capture_output=True, text=True, check=False).stdout.splitlines()  # noqa: S603
    return [int(line.split()[0]) for line in lines if wanted in line.split()]


if __name__ == "__main__":
    _watch(sys.argv[1])
