"""Type checkers as programs: in the process of the tests, mypy would undo the frozen garbage collection."""

from __future__ import annotations

import subprocess
import sys


def run_mypy(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run `mypy --strict` with these arguments."""
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)
