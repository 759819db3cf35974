"""Line input without prompt_toolkit: a thread waits for `input` on the terminal."""

from __future__ import annotations

import asyncio
from contextlib import nullcontext, suppress
from threading import Thread
from typing import TYPE_CHECKING

from mavstack.cli.shell.prompt_parts import prompt_parts

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from contextlib import AbstractContextManager

    from mavstack.cli.shell.session import Session


class PlainReader:
    """Reads lines at a prompt that does not change while it is shown."""

    def __init__(self, session: Session) -> None:
        self._session = session
        with suppress(ImportError):
            import readline  # noqa: F401 (gives `input` a history and line editing)

    async def read(self) -> str:
        """Read the next line; raise EOFError at the end of the input."""
        return await self.ask("".join(text for _, text in prompt_parts(self._session)))

    def nested(self, history: str, prompt: Callable[[], str]) -> Callable[[], Awaitable[str]]:
        """Return a function that reads a line of a session within a command; the history is shared."""
        return lambda: self.ask(prompt())

    def busy(self) -> AbstractContextManager[None]:
        """Return a context manager that leaves the terminal as it is."""
        return nullcontext()

    async def ask(self, question: str) -> str:
        """Ask a question and return the answer."""
        loop = asyncio.get_running_loop()
        answer: asyncio.Future[str] = loop.create_future()

        def settle(text: str | None) -> None:
            if answer.done():
                return
            if text is None:
                answer.set_exception(EOFError())
            else:
                answer.set_result(text)

        def read() -> None:
            try:
                text: str | None = input(question)
            except (EOFError, OSError, ValueError):
                text = None
            with suppress(RuntimeError):  # the event loop is closed
                loop.call_soon_threadsafe(settle, text)

        Thread(target=read, name="mavstack-line", daemon=True).start()
        return await answer
