"""A receiver's process as seen by the benchmark: started, connected, measured, ended."""

from __future__ import annotations

import json
import mmap
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Self

from benchmarks.measure import OURS, last_core

from .child import READY

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType


@dataclass(frozen=True, slots=True)
class Method:
    """A method to receive: a module, the name of the method in it, and the distribution that it needs."""

    name: str
    module: str
    method: str
    distribution: str = "mavstack"
    floods: bool = True  # true if it counts every message, as a flood needs
    is_called: bool = True  # false if it reads values at its own times: then it has no delay and no loss


BARE_READER = "socket, asyncio"
METHODS = (
    Method("socket, blocking", "bare_sockets", "blocking"),
    Method(BARE_READER, "bare_sockets", "asyncio"),
    Method(OURS, "ours", "called"),
    Method(f"{OURS}, async for", "ours", "iterated"),
    Method(f"{OURS}, position at 10 Hz", "ours", "read", floods=False, is_called=False),
    Method("pymavlink, recv_match", "peer_pymavlink", "loop", "pymavlink"),
    Method("pymavlink, hooks", "peer_pymavlink", "hooks", "pymavlink"),
    Method("MAVSDK, direct", "peer_mavsdk", "direct", "mavsdk"),
    Method("MAVSDK, telemetry", "peer_mavsdk", "plugin", "mavsdk", floods=False),
)


def installed() -> list[Method]:
    """Return the methods whose distribution is installed."""
    return [method for method in METHODS if find_spec(method.distribution) is not None]


@dataclass(frozen=True, slots=True)
class Received:
    """The report of a receiver; times in nanoseconds of the monotonic clock."""

    began: int
    ids: Sequence[int]
    times: Sequence[int]


class Receiver:
    """A receiving program, pinned to one core."""

    def __init__(self, method: Method) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self._file = tempfile.NamedTemporaryFile(prefix="mavstack-bench-")  # noqa: SIM115 (closed by __exit__)
        self._file.write(bytes(8))
        self._file.flush()
        self._counter = memoryview(mmap.mmap(self._file.fileno(), 8)).cast("q")
        module = f"benchmarks.telemetry.{method.module}"
        self._process = subprocess.Popen(
            [sys.executable, "-m", module, method.method, str(self.port), self._file.name],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
            cwd=Path(__file__).parents[2],
        )
        if hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(self._process.pid, {last_core()})
        if self._answer() != f"{READY}\n":
            raise RuntimeError(f"{method.name} did not start")

    @property
    def count(self) -> int:
        """Number of messages that have reached the program."""
        return self._counter[0]

    @property
    def cpu(self) -> float:
        """Processor time of the process and all its threads in seconds."""
        return time.clock_gettime(~self._process.pid << 3 | 2)  # the clock of clock_getcpuclockid(3)

    def connect(self) -> None:
        """Send the command to connect."""
        self._send_command()

    def end(self) -> Received:
        """Send the command to end, and return the report."""
        self._send_command()
        report = json.loads(self._answer())
        self._process.wait()
        return Received(report["began"], report["ids"], report["times"])

    def _send_command(self) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()

    def _answer(self) -> str:
        assert self._process.stdout is not None
        return self._process.stdout.readline()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
        self._file.close()
