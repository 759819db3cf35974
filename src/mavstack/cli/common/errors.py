"""The errors of commands: wrong usage and failures; `mav` shows each in one line."""

from __future__ import annotations

from mavstack.errors import LocalProtocolError, MavstackError


class UsageError(LocalProtocolError):
    """A command was called wrongly; the text says what is right. The exit code is 2."""


class CommandError(MavstackError):
    """A command cannot do what was asked; the text says why. The exit code is 1."""
