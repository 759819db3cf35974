"""A transfer by a separate program: started, given its job, and killed after its timeout."""

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

START_TIMEOUT = 20.0  # seconds for the start and the first heartbeat, which are not timed


@dataclass(frozen=True, slots=True)
class Program:
    """One piece of work of one peer's module; `operation` is the name of the work in that module."""

    name: str
    work: Work
    module: str
    operation: str

    def run(self, endpoint: Endpoint) -> Result:
        """Run the work once in a new process."""
        command = [sys.executable, "-m", f"benchmarks.transfers.{self.module}", self.operation]
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
                output, _ = process.communicate(_job(endpoint), timeout=endpoint.timeout + START_TIMEOUT)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                return Result(None, f"timed out after {endpoint.timeout:.0f} s")
        if not output:
            return Result(None, f"its process ended with {process.returncode}")
        answer: Answer = json.loads(output)
        return _result(answer, endpoint)


def _job(endpoint: Endpoint) -> str:
    return json.dumps(
        {
            "port": endpoint.port,
            "folder": str(endpoint.folder),
            "timeout": endpoint.timeout,
            "remote_file": endpoint.remote_file,
            "plan": [astuple(item) for item in endpoint.plan],
        }
    )


def _result(answer: Answer, endpoint: Endpoint) -> Result:
    file = endpoint.folder / Path(endpoint.remote_file).name if endpoint.remote_file else None
    seconds = answer.get("seconds")
    late = seconds is not None and seconds > endpoint.timeout
    return Result(
        seconds=None if late else seconds,
        problem=f"took {seconds:.0f} s" if late else answer.get("problem", ""),
        parameters=answer.get("parameters", {}),
        plan=tuple(Item(*item) for item in answer.get("plan", [])),
        file=file.read_bytes() if file is not None and file.is_file() else b"",
    )
