"""The loop of an interactive shell: Ctrl-C cancels a command, Ctrl-D ends the shell."""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING

from mavstack.cli.shell.interrupt import on_interrupt
from mavstack.cli.shell.notifications import print_notification
from mavstack.cli.shell.runner import report_failure, run_line
from mavstack.errors import MavstackError

_logger = logging.getLogger(__name__)

if TYPE_CHECKING:
    from collections.abc import Coroutine
    from typing import Any

    from mavstack.cli.shell.reader import LineReader
    from mavstack.cli.shell.session import Session


def line_reader(session: Session) -> LineReader:
    """Return a reader with completion and history, or a plain one if prompt_toolkit is not installed."""
    try:
        from mavstack.cli.shell.prompt_input import PromptReader
    except ImportError:
        from mavstack.cli.shell.plain_input import PlainReader

        print_notification("for completion and history: pip install 'mavstack[cli]'", "grey")
        return PlainReader(session)
    return PromptReader(session)


async def run_interactive(session: Session, reader: LineReader) -> None:
    """Read and run lines until the user exits."""
    while not session.exiting:
        try:
            text = await reader.read()
        except KeyboardInterrupt:
            continue
        except EOFError:
            return
        with reader.busy():
            completed = await run_cancellable(run_and_report(session, text))
        if not completed:
            print_notification("cancelled", "yellow")


async def run_and_report(session: Session, text: str) -> None:
    """Run a line and report a failure."""
    try:
        await run_line(session, text)
    except (MavstackError, OSError) as error:
        report_failure(error)
    except EOFError:
        print_notification("no answer", "yellow")
    except Exception as error:
        _logger.exception("a command of the shell failed unexpectedly")
        print_notification(f"unexpected error: {type(error).__name__}: {error}", "red")


async def run_cancellable(work: Coroutine[Any, Any, None]) -> bool:
    """Run a coroutine and cancel it at Ctrl-C; return whether it completed."""
    task = asyncio.get_running_loop().create_task(work)
    with on_interrupt(task.cancel):
        try:
            await asyncio.wait([task])
        except asyncio.CancelledError:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            raise
    if task.cancelled():
        return False
    task.result()
    return True
