"""A transfer that a program of its own does: started, given its job, and ended when its time is over."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from .model import Endpoint, Item, Result, Work

if TYPE_CHECKING:
    from .child import Answer

GRACE = 20.0  # for the start, and for hearing the vehicle, which are not timed


@dataclass(frozen=True, slots=True)
class Program:
    """One peer's module with one piece of work; `what` is the name it knows that by."""

    name: str
    work: Work
    module: str
    what: str

    def run(self, endpoint: Endpoint) -> Result:
        """Do it once in a fresh process."""
        command = [sys.executable, "-m", f"benchmarks.transfers.{self.module}", self.what]
        with subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
            cwd=Path(__file__).parents[2],
        ) as process:
            try:
                said, _ = process.communicate(_job(endpoint), timeout=endpoint.limit + GRACE)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                return Result(None, f"had not ended after {endpoint.limit:.0f} s")
        if not said:
            return Result(None, f"its process ended with {process.returncode}")
        answer: Answer = json.loads(said)
        return _result(answer, endpoint)


def _job(endpoint: Endpoint) -> str:
    return json.dumps(
        {
            "port": endpoint.port,
            "folder": str(endpoint.folder),
            "limit": endpoint.limit,
            "remote_file": endpoint.remote_file,
            "plan": [astuple(item) for item in endpoint.plan],
        }
    )


def _result(answer: Answer, endpoint: Endpoint) -> Result:
    file = endpoint.folder / Path(endpoint.remote_file).name if endpoint.remote_file else None
    seconds = answer.get("seconds")
    late = seconds is not None and seconds > endpoint.limit
    return Result(
        seconds=None if late else seconds,
        problem=f"took {seconds:.0f} s" if late else answer.get("problem", ""),
        parameters=answer.get("parameters", {}),
        plan=tuple(Item(*item) for item in answer.get("plan", [])),
        file=file.read_bytes() if file is not None and file.is_file() else b"",
    )
