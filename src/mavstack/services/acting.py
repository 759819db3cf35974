"""The messages that act on a vehicle: sent to the wrong one, they move it or change its settings.

All other messages to a vehicle read, answer, or describe the sender. The names are those of the one table of
`security.acting`; commands and files depend on their content.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.security.acting import acting_names
from mavstack.security.roles import Role, command_ids

if TYPE_CHECKING:
    from mavstack.dialects import Message

_COMMANDS: Final = ("COMMAND_LONG", "COMMAND_INT")
_FILES: Final = "FILE_TRANSFER_PROTOCOL"
#: The place of the operation in the payload of MAVLink FTP.
_OPCODE_AT: Final = 3
#: CreateFile, WriteFile, RemoveFile, CreateDirectory, RemoveDirectory, OpenFileWO, TruncateFile and Rename.
_WRITING_OPCODES: Final = frozenset({6, 7, 8, 9, 10, 11, 12, 13})


def acts(message: Message) -> bool:
    """Return whether a message changes something on the vehicle that receives it."""
    name = type(message).__mavlink_row__[1]
    if name in _COMMANDS:
        return int(message.command) not in command_ids(Role.OBSERVE)  # type: ignore[attr-defined]
    if name == _FILES:
        return message.payload[_OPCODE_AT] in _WRITING_OPCODES  # type: ignore[attr-defined]
    return name in _names()


@cache
def _names() -> frozenset[str]:
    return acting_names()
