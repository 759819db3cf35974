"""A receiver's process as the one who measures sees it: started, told to connect, watched, ended."""

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

from benchmarks.measure import OURS

from .child import READY

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType


@dataclass(frozen=True, slots=True)
class Way:
    """One way to receive: a module, what it calls the way, and the distribution that it needs."""

    name: str
    module: str
    way: str
    needs: str = "mavstack"
    floods: bool = True  # whether it hears every message, so that a flood can be counted


BARE = "socket, asyncio"
WAYS = (
    Way("socket, blocking", "bare", "blocking"),
    Way(BARE, "bare", "asyncio"),
    Way(OURS, "ours", "called"),
    Way(f"{OURS}, async for", "ours", "iterated"),
    Way("pymavlink, recv_match", "peer_pymavlink", "loop", "pymavlink"),
    Way("pymavlink, hooks", "peer_pymavlink", "hooks", "pymavlink"),
    Way("MAVSDK, direct", "peer_mavsdk", "direct", "mavsdk"),
    Way("MAVSDK, telemetry", "peer_mavsdk", "plugin", "mavsdk", floods=False),
)


def installed() -> list[Way]:
    """The ways that can be taken here."""
    return [way for way in WAYS if find_spec(way.needs) is not None]


@dataclass(frozen=True, slots=True)
class Heard:
    """What a receiver told at its end: times in nanoseconds of the monotonic clock."""

    began: int
    ids: Sequence[int]
    times: Sequence[int]


class Receiver:
    """A program that receives, on a core of its own where there are several."""

    def __init__(self, way: Way) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self._file = tempfile.NamedTemporaryFile(prefix="mavstack-bench-")  # noqa: SIM115 (closed by __exit__)
        self._file.write(bytes(8))
        self._file.flush()
        self._counter = memoryview(mmap.mmap(self._file.fileno(), 8)).cast("q")
        module = f"benchmarks.telemetry.{way.module}"
        self._process = subprocess.Popen(
            [sys.executable, "-m", module, way.way, str(self.port), self._file.name],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
            cwd=Path(__file__).parents[2],
        )
        if hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(self._process.pid, {max(os.sched_getaffinity(self._process.pid))})
        if self._answer() != f"{READY}\n":
            raise RuntimeError(f"{way.name} did not start")

    @property
    def count(self) -> int:
        """How many messages were with the program until now."""
        return self._counter[0]

    @property
    def cpu(self) -> float:
        """Seconds of processor time that the process took until now, all threads together."""
        return time.clock_gettime(~self._process.pid << 3 | 2)  # what clock_getcpuclockid(3) gives

    def connect(self) -> None:
        """Tell it to begin."""
        self._say()

    def end(self) -> Heard:
        """Tell it to end, and take its report."""
        self._say()
        report = json.loads(self._answer())
        self._process.wait()
        return Heard(report["began"], report["ids"], report["times"])

    def _say(self) -> None:
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
