"""The input line of a shell, as the commands see it; `prompt_input` and `plain_input` implement it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from contextlib import AbstractContextManager


class LineReader(Protocol):
    """Reads lines from the user."""

    async def read(self) -> str:
        """Read the next line; raise EOFError at the end, KeyboardInterrupt for Ctrl-C."""

    async def ask(self, question: str) -> str:
        """Ask a question and return the answer."""

    def nested(self, history: str, prompt: Callable[[], str]) -> Callable[[], Awaitable[str]]:
        """Return a function that reads a line of a session within a command, with a history of its own."""

    def busy(self) -> AbstractContextManager[None]:
        """Return a context manager for the time in which a command runs."""
