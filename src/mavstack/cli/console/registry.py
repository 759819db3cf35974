"""Every command of the shell, by each of its names."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.cli.console import control, flying, looking, raw, stored

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.cli.console.command import Command

COMMANDS: Final[Mapping[str, Command]] = MappingProxyType(
    {
        name: command
        for family in (flying, stored, looking, raw, control)
        for command in family.COMMANDS
        for name in command.names
    }
)
