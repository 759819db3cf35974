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

#: Longer than anything takes on a busy machine.
PATIENCE = 60.0
#: Datagrams get lost if it is busy, and it asks for some things once only.
AGAIN = 8.0
#: What it prints if something is wrong.
COMPLAINTS = re.compile(
    r"traceback|error|exception|unknown|unable|failed|unsupported|denied|rejected|bad |bug|missing|usage:",
    re.IGNORECASE,
)


class Console:
    """Its command line: says a line, waits for what it prints."""

    def __init__(self, process: asyncio.subprocess.Process, directory: Path) -> None:
        self.directory = directory
        #: All that it printed.
        self.printed = ""
        self._process = process
        self._heard_up_to = 0
        self._came = asyncio.Event()

    def say(self, line: str) -> None:
        self._process.stdin.write(line.encode() + b"\n")

    async def listen(self) -> None:
        """Take in what it prints, so that it never waits for us."""
        while more := await self._process.stdout.read(1 << 16):
            self.printed += more.decode(errors="replace")
            self._came.set()
        self.printed += "\n-- MAVProxy ended --"
        self._came.set()

    async def hear(self, *wanted: str, within: float = PATIENCE) -> None:
        """Wait for texts, one after the other; what comes after them is left for the next."""
        for text in wanted:
            try:
                async with asyncio.timeout(within):
                    while (found := self.printed.find(text, self._heard_up_to)) < 0:
                        self._came.clear()
                        await self._came.wait()
            except TimeoutError:
                raise AssertionError(f"no {text!r} in: {self.printed[self._heard_up_to :]}") from None
            self._heard_up_to = found + len(text)

    async def ask(self, line: str, *wanted: str) -> None:
        """Say a line that may be said twice, until it is answered."""
        for left in (2, 1, 0):
            self.say(line)
            try:
                return await self.hear(*wanted, within=AGAIN if left else PATIENCE)
            except AssertionError:
                if not left:
                    raise
        raise AssertionError("not reached")

    def complaints(self, *allowed: str) -> list[str]:
        """The lines that say that something is wrong, without those with one of these texts in them."""
        lines = (line for line in self.printed.splitlines() if COMPLAINTS.search(line))
        return [line for line in lines if not any(text in line for text in allowed)]


@asynccontextmanager
async def mavproxy(port: int, directory: Path, *, modules: str | None = None):
    """MAVProxy with its default modules, or those that are named."""
    command = (
        *(sys.executable, "-W", "ignore", "-u", "-m", "MAVProxy.mavproxy"),
        *(f"--master=udpout:127.0.0.1:{port}", "--nowait"),
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
    listening = asyncio.create_task(console.listen())
    try:
        yield console
    finally:
        with suppress(ProcessLookupError):
            process.kill()
        await listening
        await process.wait()
