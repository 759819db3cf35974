"""MAVProxy as a peer in a test: a ground station with a command line, in a process of its own."""

from __future__ import annotations

import asyncio
import os
import re
import sys
from contextlib import asynccontextmanager, suppress
from importlib.util import find_spec
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

needs_mavproxy = pytest.mark.skipif(find_spec("MAVProxy") is None, reason="MAVProxy is not installed")

#: Seconds for one answer, enough for a busy machine.
TIMEOUT = 60.0
#: Seconds until a line is sent again: MAVProxy loses datagrams when busy, and requests some things only once.
RETRY_TIMEOUT = 8.0
#: Words that MAVProxy prints with an error.
ERROR_PATTERN = re.compile(
    r"traceback|error|exception|unknown|unable|failed|unsupported|denied|rejected|bad |bug|missing|usage:",
    re.IGNORECASE,
)


class Console:
    """The command line of MAVProxy: send lines, wait for output."""

    def __init__(self, process: asyncio.subprocess.Process, directory: Path) -> None:
        self.directory = directory
        #: All output so far.
        self.printed = ""
        self._process = process
        self._position = 0
        self._new_output = asyncio.Event()

    def send_line(self, line: str) -> None:
        self._process.stdin.write(line.encode() + b"\n")

    async def read_output(self) -> None:
        """Read the output continuously, so that MAVProxy never blocks on a full pipe."""
        while more := await self._process.stdout.read(1 << 16):
            self.printed += more.decode(errors="replace")
            self._new_output.set()
        self.printed += "\n-- MAVProxy ended --"
        self._new_output.set()

    async def wait_for_output(self, *expected: str, timeout: float = TIMEOUT) -> None:
        """Wait for texts in this order; output behind the last one is left for the next call."""
        for text in expected:
            try:
                async with asyncio.timeout(timeout):
                    while (found := self.printed.find(text, self._position)) < 0:
                        self._new_output.clear()
                        await self._new_output.wait()
            except TimeoutError:
                raise AssertionError(f"no {text!r} in: {self.printed[self._position :]}") from None
            self._position = found + len(text)

    async def send_until_answered(self, line: str, *expected: str) -> None:
        """Send a line, again if need be, until the expected output is printed; only for idempotent lines."""
        for left in (2, 1, 0):
            self.send_line(line)
            try:
                return await self.wait_for_output(*expected, timeout=RETRY_TIMEOUT if left else TIMEOUT)
            except AssertionError:
                if not left:
                    raise
        raise AssertionError("not reached")

    def errors(self, *allowed: str) -> list[str]:
        """Return the output lines that report an error, except those that contain an allowed text."""
        lines = (line for line in self.printed.splitlines() if ERROR_PATTERN.search(line))
        return [line for line in lines if not any(text in line for text in allowed)]


@asynccontextmanager
async def mavproxy(port: int, directory: Path, *, modules: str | None = None, transport: str = "udpout"):
    """Run MAVProxy with the given modules, or its default ones; `transport` is udpout or tcp."""
    command = (
        *(sys.executable, "-W", "ignore", "-u", "-m", "MAVProxy.mavproxy"),
        *(f"--master={transport}:127.0.0.1:{port}", "--nowait"),
        *(f"--state-basedir={directory}", f"--logfile={directory / 'telemetry.log'}"),
        *(() if modules is None else (f"--default-modules={modules}",)),
    )
    process = await asyncio.create_subprocess_exec(
        *command,
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.STDOUT,
        cwd=directory,
        env={**os.environ, "HOME": str(directory)},
    )
    console = Console(process, directory)
    reading = asyncio.create_task(console.read_output())
    try:
        yield console
    finally:
        with suppress(ProcessLookupError):
            process.kill()
        await reading
        await process.wait()
