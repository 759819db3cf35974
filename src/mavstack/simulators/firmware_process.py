"""A running firmware program: its output by lines, its end with this process."""

from __future__ import annotations

import asyncio
import os
import re
import sys
from contextlib import suppress
from pathlib import Path
from signal import Signals
from subprocess import DEVNULL, PIPE, STDOUT
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final, Self

from mavstack.errors import InvalidStateError

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from mavstack.simulators.firmware_command import FirmwareCommand

#: Seconds that a program gets to end by itself.
GRACE: Final = 3.0
MAX_LINE: Final = 1 << 20
#: The ANSI colour codes in PX4's messages.
_COLOUR: Final = re.compile(r"\x1b\[[0-9;]*m")


class FirmwareProcess:
    """A firmware program in its own folder; use it as an asynchronous context manager.

    Args:
        command: The program.
        folder: Its folder, which is made; None: a temporary one, removed at the end.
        on_line: Called with each line of its output.

    Attributes:
        folder: Its folder.
    """

    def __init__(
        self,
        command: FirmwareCommand,
        *,
        folder: Path | None = None,
        on_line: Callable[[str], None] = lambda line: None,
    ) -> None:
        self._command, self._on_line = command, on_line
        self._temporary = TemporaryDirectory(prefix="mavstack-firmware-") if folder is None else None
        self.folder = Path(self._temporary.name) if self._temporary else Path(folder or ".")
        self._process: asyncio.subprocess.Process | None = None
        self._reader: asyncio.Task[None] | None = None

    async def wait(self) -> int:
        """Wait until the program ends by itself; returns its exit code."""
        if self._process is None:
            raise InvalidStateError("the firmware was not started")
        code = await self._process.wait()
        if self._reader is not None:
            await self._reader
        return code

    async def __aenter__(self) -> Self:
        self.folder.mkdir(parents=True, exist_ok=True)
        for name, text in self._command.files.items():
            (self.folder / name).write_text(text)
        try:
            self._process = await asyncio.create_subprocess_exec(
                *self._command.words,
                stdin=DEVNULL,
                stdout=PIPE,
                stderr=STDOUT,
                cwd=self.folder,
                env={**os.environ, **self._command.environment},
                limit=MAX_LINE,
                start_new_session=sys.platform != "win32",
            )
        except OSError as error:
            self._remove()
            raise InvalidStateError(
                f"starting {self._command.words[0]} failed: {error.strerror or error}"
            ) from error
        self._reader = asyncio.get_running_loop().create_task(self._read())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        process = self._process
        if process is not None and process.returncode is None:
            self._signal(process, Signals.SIGTERM)
            with suppress(TimeoutError):
                await asyncio.wait_for(asyncio.shield(process.wait()), GRACE)
            if process.returncode is None:
                self._kill(process)
                await process.wait()
        if self._reader is not None:
            self._reader.cancel()
            with suppress(asyncio.CancelledError):
                await self._reader
        self._remove()

    async def _read(self) -> None:
        output = self._process.stdout if self._process else None
        while output is not None:
            try:
                line = await output.readline()
            except ValueError:  # the line is longer than `MAX_LINE`
                continue
            if not line:
                return
            self._on_line(_COLOUR.sub("", line.decode(errors="replace")).rstrip())

    def _signal(self, process: asyncio.subprocess.Process, signal: Signals) -> None:
        """Send a signal to the program and its children."""
        with suppress(ProcessLookupError, PermissionError):
            if sys.platform == "win32":
                process.terminate()
            else:
                os.killpg(process.pid, signal)

    def _kill(self, process: asyncio.subprocess.Process) -> None:
        if sys.platform == "win32":
            process.kill()
        else:
            self._signal(process, Signals.SIGKILL)

    def _remove(self) -> None:
        if self._temporary is not None:
            self._temporary.cleanup()
