"""The loop of a shell that somebody types into: Ctrl-C ends a command, Ctrl-D the shell."""

from __future__ import annotations

import asyncio
import signal
from contextlib import suppress
from typing import TYPE_CHECKING, Protocol

from mavstack.cli.shell.notifications import announce
from mavstack.cli.shell.runner import run_line, tell_failure
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from contextlib import AbstractContextManager
    from typing import Any

    from mavstack.cli.shell.session import Session


class Line(Protocol):
    """What reads lines."""

    async def read(self) -> str:
        """The next line; raises EOFError at the end, KeyboardInterrupt for Ctrl-C."""

    async def ask(self, question: str) -> str:
        """The answer to a question."""

    def busy(self) -> AbstractContextManager[None]:
        """What holds while a command runs."""


def line_for(session: Session) -> Line:
    """The line with completion, or a plain one where that is not installed."""
    try:
        from mavstack.cli.shell.prompt_input import PromptLine
    except ImportError:
        from mavstack.cli.shell.plain_input import PlainLine

        announce("without completion and history; with them: pip install 'mavstack[cli]'", "grey")
        return PlainLine(session)
    return PromptLine(session)


async def interact(session: Session, line: Line) -> None:
    """Read and run lines until the user leaves."""
    while not session.leaving:
        try:
            text = await line.read()
        except KeyboardInterrupt:
            continue
        except EOFError:
            return
        with line.busy():
            done = await uninterrupted(run_one(session, text))
        if not done:
            announce("cancelled", "yellow")


async def run_one(session: Session, text: str) -> None:
    """Run a line, and tell what fails."""
    try:
        await run_line(session, text)
    except (MavstackError, OSError) as error:
        tell_failure(error)
    except EOFError:
        announce("no answer", "yellow")
    except Exception as error:  # noqa: BLE001 (a defect of one command must not end the shell in flight)
        announce(f"a defect of this command: {type(error).__name__}: {error}", "red")


async def uninterrupted(work: Coroutine[Any, Any, None]) -> bool:
    """Do it, or cancel it at Ctrl-C; whether it was done."""
    task = asyncio.get_running_loop().create_task(work)
    release = _on_interrupt(task.cancel)
    try:
        await asyncio.wait([task])
    except asyncio.CancelledError:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        raise
    finally:
        release()
    if task.cancelled():
        return False
    task.result()
    return True


def _on_interrupt(act: Callable[[], object]) -> Callable[[], None]:
    """Have Ctrl-C do something else until the result is called."""
    loop = asyncio.get_running_loop()
    before = signal.getsignal(signal.SIGINT)

    def act_soon(*_: object) -> None:
        loop.call_soon_threadsafe(act)

    try:
        loop.add_signal_handler(signal.SIGINT, act)
    except (NotImplementedError, RuntimeError, ValueError):  # Windows
        try:
            signal.signal(signal.SIGINT, act_soon)
        except ValueError:  # not in the main thread: nobody sends it a signal
            return lambda: None

    def release() -> None:
        with suppress(NotImplementedError):
            loop.remove_signal_handler(signal.SIGINT)
        signal.signal(signal.SIGINT, before)

    return release
