"""The command protocol: commands to a component, and their acknowledgements (guide: command protocol)."""

from mavstack.services.command.client import CommandClient, CommandOperation, CommandResult
from mavstack.services.command.command import Command
from mavstack.services.command.server import (
    CommandCancelRequested,
    CommandRequest,
    CommandServer,
    CommandStarted,
)

__all__ = [
    "Command",
    "CommandCancelRequested",
    "CommandClient",
    "CommandOperation",
    "CommandRequest",
    "CommandResult",
    "CommandServer",
    "CommandStarted",
]
