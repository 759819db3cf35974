"""Commands of the shell from other packages: entry points of the group `mavstack.console_commands`.

An entry point has the name of the command and loads a `Command`. A plug-in that cannot be loaded, or whose
names are taken, is reported in one line, and the shell starts without it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.errors import CommandError
from mavstack.cli.shell.session import Command
from mavstack.errors import InvalidArgumentError
from mavstack.plugins import Registry

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

    def convert(entry: EntryPoint, loaded: Any) -> Command:  # noqa: ANN401 - of another package
        return _checked(entry, loaded, commands)

    registry: Registry[Command] = Registry(
        "command",
        GROUP,
        objects=lambda: builtin,
        convert=convert,
        report=lambda line: report(CommandError(line)),
    )
    for _, command in registry.plugin_items():
        commands.update(dict.fromkeys(command.names, command))
    return commands


def _checked(entry: EntryPoint, loaded: object, commands: Mapping[str, Command]) -> Command:
    if not isinstance(loaded, Command):
        raise InvalidArgumentError(f"{entry.value} is a {type(loaded).__name__}, not a Command")
    if loaded.name != entry.name:
        raise InvalidArgumentError(f"its command is named {loaded.name!r}, its entry point {entry.name!r}")
    if taken := sorted(set(loaded.names) & set(commands)):
        raise InvalidArgumentError(f"there is a command {taken[0]!r} already")
    return loaded
