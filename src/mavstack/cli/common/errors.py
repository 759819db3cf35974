"""The errors of commands: wrong usage and failures; `mav` shows each in one line."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import LocalProtocolError, MavstackError, RemoteError

if TYPE_CHECKING:
    from collections.abc import Mapping

#: The command-line option that raises each limit of the API, by the name of the argument.
_OPTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {"max_size": "--max-size", "max_entries": "--max-entries", "timeout": "--action-timeout"}
)


class UsageError(LocalProtocolError):
    """A command was called wrongly; the text says what is right. The exit code is 2."""


class CommandError(MavstackError):
    """A command cannot do what was asked; the text says why. The exit code is 1."""


def failure_text(error: BaseException) -> str:
    """Return an error in one line; a limit that was exceeded is named by the option that raises it."""
    text = " ".join(str(error).split())
    if isinstance(error, RemoteError) and error.limit in _OPTIONS:
        return text.replace(f"{error.limit}= allows", f"{_OPTIONS[error.limit]} allows")
    return text
