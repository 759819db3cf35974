"""The command `mav shell`; the names here are the interface of plug-ins (see `plugins`)."""

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.shell.session import Command, Session

__all__ = ["Command", "CommandError", "Session", "UsageError"]
