"""How a command says that it was called in a way that makes no sense."""

from __future__ import annotations

from mavstack.errors import LocalProtocolError


class UsageError(LocalProtocolError):
    """The command was called wrongly; the text says what would be right."""
