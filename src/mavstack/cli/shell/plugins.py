"""Commands of the shell from other packages: entry points of the group `mavstack.console_commands`.

An entry point has the name of the command and loads a `Command`. A plug-in that cannot be loaded, or whose
names are taken, is reported in one line, and the shell starts without it.
"""

from __future__ import annotations

from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError
from mavstack.cli.shell.session import Command

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from importlib.metadata import EntryPoint

GROUP: Final = "mavstack.console_commands"


def with_plugins(
    builtin: Mapping[str, Command], report: Callable[[CommandError], None]
) -> dict[str, Command]:
    """Return the built-in commands and those of installed packages, by each of their names.

    Args:
        builtin: The commands of the shell.
        report: Called with the problem of each plug-in that is left out.
    """
    commands = dict(builtin)
    for entry in sorted(entry_points(group=GROUP), key=lambda each: each.name):
        try:
            command = _load(entry)
            if taken := sorted(set(command.names) & set(commands)):
                raise CommandError(f"there is a command {taken[0]!r} already")
        except Exception as error:  # noqa: BLE001 (the code of another package may raise anything)
            report(CommandError(f"plug-in {_name(entry)} was left out: {_reason(error)}"))
        else:
            commands.update(dict.fromkeys(command.names, command))
    return commands


def _load(entry: EntryPoint) -> Command:
    command = entry.load()
    if not isinstance(command, Command):
        raise CommandError(f"{entry.value} is a {type(command).__name__}, not a Command")
    if command.name != entry.name:
        raise CommandError(f"its command is named {command.name!r}, its entry point {entry.name!r}")
    return command


def _name(entry: EntryPoint) -> str:
    return f"{entry.name} of {entry.dist.name}" if entry.dist is not None else entry.name


def _reason(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text if isinstance(error, CommandError) else f"{type(error).__name__}: {text}"
