"""The error of a command line that makes no sense."""

from __future__ import annotations

from mavstack.errors import LocalProtocolError


class UsageError(LocalProtocolError):
    """A command was called wrongly; the text says what is right."""
