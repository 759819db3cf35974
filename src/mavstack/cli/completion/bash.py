"""The completion script for bash, from version 3.2 on."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mavstack.cli.completion.command_words import CommandWords

#: The file with the script, a template for `str.format`.
_FILE: Final = "mav.bash"


def script(commands: Sequence[CommandWords]) -> str:
    """Return the script."""
    return (
        (files(__package__) / _FILE)
        .read_text("utf-8")
        .format(
            paths=" | ".join(f'"{each.path}"' for each in commands[1:]),
            values="\n".join(_values(commands)),
            options="\n".join(
                f'                    "{each.path}") {_words(_names(each))} ;;' for each in commands
            ),
            words="\n".join(
                f'                    "{each.path}") {_words(word for word, _ in each.words)}'
                f"{' files=1' if each.files else ''} ;;"
                for each in commands
                if each.words or each.files
            ),
        )
    )


def _values(commands: Iterable[CommandWords]) -> Iterable[str]:
    """Yield the cases of options with a value; most have neither choices nor files."""
    for each in commands:
        for option in each.options:
            if option.takes_value:
                names = " | ".join(f'"{each.path} {name}"' for name in option.names)
                values = "files=1" if option.files else _words(option.choices) if option.choices else ":"
                yield f"        {names}) {values} ;;"


def _names(command: CommandWords) -> Iterable[str]:
    return (name for option in command.options for name in option.names)


def _words(words: Iterable[str]) -> str:
    return f'words="{" ".join(words)}"'
