"""The completion script for zsh."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mavstack.cli.completion.command_words import CommandWords, OptionWords

#: The file with the script, a template for `str.format`.
_FILE: Final = "mav.zsh"


def script(commands: Sequence[CommandWords]) -> str:
    """Return the script."""
    return (
        (files(__package__) / _FILE)
        .read_text("utf-8")
        .format(
            paths="|".join(f'"{each.path}"' for each in commands[1:]),
            values="\n".join(_values(commands)),
            options="\n".join(
                f'            ("{each.path}") items=({_items(_option_items(each.options))}) ;;'
                for each in commands
            ),
            words="\n".join(
                f'        ("{each.path}") items=({_items(each.words)}){" files=1" if each.files else ""} ;;'
                for each in commands
                if each.words or each.files
            ),
        )
    )


def _values(commands: Iterable[CommandWords]) -> Iterable[str]:
    for each in commands:
        for option in each.options:
            if option.takes_value:
                names = "|".join(f'"{each.path} {name}"' for name in option.names)
                yield f"        ({names}) {_complete_value(option)}; return ;;"


def _complete_value(option: OptionWords) -> str:
    if option.files:
        return "_files"
    if option.choices:
        return f"choices=({' '.join(map(_quoted, option.choices))}); compadd -a choices"
    return f"_message {_quoted(option.summary)}"


def _option_items(options: Iterable[OptionWords]) -> Iterable[tuple[str, str]]:
    return ((name, option.summary) for option in options for name in option.names)


def _items(items: Iterable[tuple[str, str]]) -> str:
    return " ".join(_quoted(f"{name}:{summary}" if summary else name) for name, summary in items)


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "'\\''") + "'"
