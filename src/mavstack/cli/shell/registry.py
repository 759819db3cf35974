"""The commands of the shell by each of their names."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.cli.shell import control, equipment, flight, inspection, part_calls, payload, raw, storage

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.cli.shell.session import Command

COMMANDS: Final[Mapping[str, Command]] = MappingProxyType(
    {
        name: command
        for family in (flight, equipment, payload, storage, inspection, raw, part_calls, control)
        for command in family.COMMANDS
        for name in command.names
    }
)
