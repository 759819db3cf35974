"""An interactive session in the shell of a vehicle (PX4's nsh, over SERIAL_CONTROL).

Lines are edited here, with a history of their own, and sent when they are complete; output appears above the
line that is being typed, as it arrives. The unfinished last line of the output is the prompt, usually
`nsh> `. Ctrl-C is passed on and interrupts the command on the vehicle; Ctrl-D leaves.
"""

from __future__ import annotations

import asyncio
import re
from contextlib import suppress
from typing import TYPE_CHECKING, Final, Protocol

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.text import printable
from mavstack.cli.shell.interrupt import on_interrupt
from mavstack.cli.watch.link_follower import background_tasks

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.cli.shell.session import Session

#: Seconds to wait for the prompt.
FIRST_ANSWER_TIMEOUT: Final = 6.0
#: The prompt of PX4's shell.
PROMPT: Final = "nsh> "
INTERRUPT: Final = b"\x03"
NO_ANSWER: Final = "no shell answered; only PX4 has one"
#: Name of the input history of this shell.
HISTORY: Final = "nsh"
ESCAPES: Final = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")


class RemoteShell(Protocol):
    """The part of `mavstack.node.shell.Shell` that a session uses."""

    def write(self, data: bytes) -> None:
        """Send bytes."""

    def write_line(self, text: str) -> None:
        """Send a line."""

    def __aiter__(self) -> AsyncIterator[str]:
        """Iterate over the output."""


class ShellOutput:
    """Splits the output of a shell into lines, and finds its prompt; the echo of a sent line is left out."""

    def __init__(self) -> None:
        self._rest = ""
        self._echo: str | None = None

    @property
    def prompt(self) -> str:
        """The unfinished last line."""
        return printable(self._rest)

    def sent(self, line: str) -> None:
        """Expect the echo of a line that was sent."""
        self._echo = line.strip()
        self._rest = ""

    def feed(self, text: str) -> list[str]:
        """Add output; return the complete lines, without escape sequences."""
        text = ESCAPES.sub("", self._rest + text).replace("\r", "")
        *lines, self._rest = text.split("\n")
        return [printable(line.expandtabs(8)).rstrip() for line in lines if not self._is_echo(line)]

    def _is_echo(self, line: str) -> bool:
        """Return whether a line is the one that was sent, or an empty prompt."""
        if line.strip() == PROMPT.strip():
            return True
        if self._echo is None or line.removeprefix(PROMPT).strip() != self._echo:
            return False
        self._echo = None
        return True


async def run_session(session: Session, shell: RemoteShell) -> None:
    """Pass lines to the shell and show its output, until Ctrl-D.

    Raises:
        CommandError: No shell answers.
    """
    output, opened = ShellOutput(), asyncio.Event()
    output.sent("")
    shell.write_line("")  # a shell that is already in use answers an empty line with its prompt

    async def show() -> None:
        async for text in shell:
            opened.set()
            session.print(*output.feed(text))

    async with background_tasks(show()):
        try:
            async with asyncio.timeout(FIRST_ANSWER_TIMEOUT):
                await opened.wait()
        except TimeoutError:
            raise CommandError(NO_ANSWER) from None
        session.print("Ctrl-C interrupts the command on the vehicle, Ctrl-D leaves its shell.")
        await _read_lines(session, shell, output)


async def _read_lines(session: Session, shell: RemoteShell, output: ShellOutput) -> None:
    if session.reader is None:
        raise CommandError("a shell session needs a terminal; nsh COMMAND runs one command")
    lines = session.reader.nested(HISTORY, lambda: output.prompt)
    with on_interrupt(lambda: shell.write(INTERRUPT)), suppress(EOFError):
        while True:
            try:
                line = await lines()
            except KeyboardInterrupt:  # Ctrl-C as a key of a terminal in raw mode, not as a signal
                shell.write(INTERRUPT)
                continue
            output.sent(line)
            shell.write_line(line)
