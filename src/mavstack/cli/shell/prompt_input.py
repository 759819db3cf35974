"""Line input with prompt_toolkit: completion, history, and a prompt that shows the state of the vehicle.

This is the only module that uses prompt_toolkit; without it `plain_input` reads lines.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from prompt_toolkit import PromptSession
from prompt_toolkit.auto_suggest import AutoSuggestFromHistory
from prompt_toolkit.completion import Completer, Completion
from prompt_toolkit.history import FileHistory, InMemoryHistory
from prompt_toolkit.patch_stdout import patch_stdout
from prompt_toolkit.shortcuts import CompleteStyle
from prompt_toolkit.styles import Style

from mavstack.cli.common.text import printable
from mavstack.cli.shell.completion import complete
from mavstack.cli.shell.prompt_parts import prompt_parts
from mavstack.cli.shell.state import history_file
from mavstack.cli.shell.terminal import echo_disabled

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Awaitable, Callable, Iterable
    from contextlib import AbstractContextManager

    from prompt_toolkit.completion import CompleteEvent
    from prompt_toolkit.document import Document
    from prompt_toolkit.formatted_text import AnyFormattedText
    from prompt_toolkit.history import History

    from mavstack.cli.shell.session import Session

#: Seconds between two updates of the prompt.
_REFRESH_INTERVAL: Final = 0.5
_STYLE: Final = Style.from_dict(
    {"system": "bold", "mode": "ansicyan", "armed": "bold ansired", "silent": "ansiyellow", "end": ""}
)


class PromptReader:
    """Reads lines at a prompt that is updated."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._prompt: PromptSession[str] = PromptSession(
            history=_history("shell"),
            completer=_Completer(session),
            complete_while_typing=False,
            complete_style=CompleteStyle.MULTI_COLUMN,
            auto_suggest=AutoSuggestFromHistory(),
            refresh_interval=_REFRESH_INTERVAL,
            style=_STYLE,
        )

    async def read(self) -> str:
        """Read the next line; raise EOFError for Ctrl-D and KeyboardInterrupt for Ctrl-C."""
        with patch_stdout(raw=True):
            return await self._prompt.prompt_async(self._message)

    async def ask(self, question: str) -> str:
        """Ask a question and return the answer, which does not go to the history."""
        prompt: PromptSession[str] = PromptSession()
        return await prompt.prompt_async(question)

    def nested(self, history: str, prompt: Callable[[], str]) -> Callable[[], Awaitable[str]]:
        """Return a function that reads a line of a session within a command, with a history of its own."""
        lines: PromptSession[str] = PromptSession(
            history=_history(history),
            auto_suggest=AutoSuggestFromHistory(),
            refresh_interval=_REFRESH_INTERVAL,
        )

        async def read() -> str:
            with patch_stdout(raw=True):
                return await lines.prompt_async(prompt)

        return read

    def busy(self) -> AbstractContextManager[None]:
        """Return a context manager that keeps typed letters out of the output of a command."""
        return echo_disabled()

    def _message(self) -> AnyFormattedText:
        return [(f"class:{name}", text) for name, text in prompt_parts(self._session)]


def _history(name: str) -> History:
    path = history_file(name)
    return InMemoryHistory() if path is None else FileHistory(str(path))


class _Completer(Completer):
    """Completes words with `completion.complete`."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def get_completions(self, document: Document, complete_event: CompleteEvent) -> Iterable[Completion]:
        """Return nothing: only the asynchronous method can ask the vehicle."""
        return ()

    async def get_completions_async(
        self, document: Document, complete_event: CompleteEvent
    ) -> AsyncGenerator[Completion, None]:
        """Yield the candidates for the word at the cursor."""
        found, length = await complete(self._session, document.text_before_cursor)
        for text in found:
            shown = text.rstrip("/").rpartition("/")[2] + ("/" if text.endswith("/") else "")
            quoted = f'"{text}"' if " " in text else text
            note = getattr(text, "note", "")
            yield Completion(quoted, start_position=-length, display=shown, display_meta=printable(note))
