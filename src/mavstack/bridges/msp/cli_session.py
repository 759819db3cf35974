"""The asyncio driver of the command line interface (CLI) of a flight controller.

    async with controller.cli() as cli:
        print(await cli.run("get gyro"))
        await cli.save()

Firmwares leave the CLI by a restart, so the controller restarts when the block ends, and settings that were
not saved are lost.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidStateError, LinkClosedError, MspDenied, MspTimeout
from mavstack.msp.cli import ENTER, CliDialog, errors_in, is_leaving, restore_lines

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.bridges.msp.connection import RawLine

#: Seconds to wait for the prompt, and number of attempts to open the CLI.
ENTER_TIMEOUT: Final = 2.0
ENTER_ATTEMPTS: Final = 2
#: Seconds without a byte after which a line has failed.
IDLE_TIMEOUT: Final = 5.0
#: Seconds to wait for the text that a restarting controller prints.
LEAVE_TIMEOUT: Final = 1.0
#: The CLI commands that print all settings or the changed ones.
DUMPS: Final = ("diff all", "diff", "dump all", "dump")


class CliSession:
    """The open CLI of a flight controller; made by `FlightController.cli`."""

    def __init__(self, line: RawLine, target: str) -> None:
        self._line = line
        self._target = target
        self._dialog = CliDialog()
        self.closed = False

    async def enter(self) -> str:
        """Open the CLI.

        Returns:
            Its greeting.

        Raises:
            MspTimeout: No prompt came.
        """
        for _ in range(ENTER_ATTEMPTS):
            self._line.write(ENTER)
            with suppress(TimeoutError):
                async with asyncio.timeout(ENTER_TIMEOUT):
                    while not self._dialog.at_prompt:
                        self._dialog.receive(await self._line.read())
                    return self._rest("")
        raise MspTimeout("opening the CLI of", self._target, attempts=ENTER_ATTEMPTS, answer="no prompt")

    async def run(self, line: str, *, timeout: float | None = None) -> str:  # noqa: ASYNC109 (typed error)
        """Send a line, and wait for its reply.

        Args:
            line: A command, such as `get gyro`.
            timeout: Seconds for the whole reply; None: as long as text comes.

        Returns:
            The reply without the echo of the line and without the prompt. After a line that restarts the
            controller, the text that came until then.

        Raises:
            MspTimeout: The reply did not come in time.
            InvalidArgumentError: The CLI does not take the line.
            InvalidStateError: A line before has closed the CLI.
            LinkClosedError: The link is down.
        """
        if self.closed:
            raise InvalidStateError("the CLI is closed: the controller restarts")
        self._line.write(self._dialog.send(line))
        if is_leaving(line):
            return await self._leave(line)
        try:
            async with asyncio.timeout(timeout):
                return await self._reply()
        except TimeoutError:
            raise MspTimeout(f"CLI command {line!r} on", self._target, answer="no complete reply") from None

    async def dump(self, scope: str = "diff all") -> str:
        """Return settings as commands of the CLI, from which `restore` makes them again.

        Args:
            scope: `diff all`, `diff`, `dump all` or `dump`.

        Raises:
            MspTimeout: The reply did not come in time.
            LinkClosedError: The link is down.
        """
        return await self.run(scope) + "\n"

    async def restore(self, dump: str, progress: Callable[[int, int], None] | None = None) -> int:
        """Apply the commands of a dump and save them; the controller restarts.

        Nothing is saved if a command has an error: the controller restarts with its old settings.

        Args:
            dump: The text of a dump.
            progress: Called with the number of commands that were sent, and of all.

        Returns:
            The number of commands.

        Raises:
            MspDenied: Commands had errors; the text has the first of them with their lines.
            MspTimeout: A reply did not come in time.
            InvalidArgumentError: A line of the dump cannot be sent; nothing was sent.
            LinkClosedError: The link is down.
        """
        commands = restore_lines(dump)
        errors: list[str] = []
        for done, (number, line) in enumerate(commands, 1):
            reply = await self.run(line)
            errors += [f"line {number}, {line!r}: {error}" for error in errors_in(reply)]
            if progress is not None:
                progress(done, len(commands))
        if errors:
            await self.exit()
            more = f"; and {len(errors) - 3} more" if len(errors) > 3 else ""
            answer = f"{'; '.join(errors[:3])}{more}; nothing was saved"
            raise MspDenied("restoring the settings of", self._target, answer=answer)
        await self.save()
        return len(commands)

    async def save(self) -> None:
        """Save all settings and restart the controller, which closes the CLI.

        Raises:
            MspDenied: The firmware refused it, because of errors before.
        """
        text = await self.run("save")
        if errors := errors_in(text):
            raise MspDenied("saving the settings of", self._target, answer="; ".join(errors))

    async def exit(self) -> None:
        """Close the CLI without saving, which restarts the controller. Idempotent."""
        if not self.closed:
            with suppress(LinkClosedError, MspTimeout):
                await self.run("exit")

    async def _reply(self) -> str:
        while (reply := self._dialog.reply()) is None:
            async with asyncio.timeout(IDLE_TIMEOUT):
                self._dialog.receive(await self._line.read())
        return reply

    async def _leave(self, line: str) -> str:
        """Take the text until the controller restarts, or shows a prompt because it refused."""
        with suppress(TimeoutError, LinkClosedError):
            while True:
                async with asyncio.timeout(LEAVE_TIMEOUT):
                    self._dialog.receive(await self._line.read())
                if self._dialog.at_prompt and errors_in(self._dialog.text):
                    return self._rest(line)
        self.closed = True
        return self._rest(line)

    def _rest(self, line: str) -> str:
        """Return the text without the echo of a line and without the prompt."""
        return self._dialog.text.removeprefix(line).removesuffix("\n# ").strip("\n")
