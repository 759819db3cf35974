"""The completion script for fish."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.cli.completion.command_words import CommandWords, OptionWords

_HEAD: Final = """\
# Completion of mav in fish. For all sessions:
#   mav completion fish > ~/.config/fish/completions/mav.fish

function __mav_at
    set -l at mav
    for word in (commandline -opc)[2..-1]
        switch "$at $word"
            case {paths}
                set at "$at $word"
        end
    end
    test "$at" = "$argv"
end

complete -c mav -f
"""


def script(commands: Sequence[CommandWords]) -> str:
    """Return the script."""
    lines = [line for each in commands for line in _command(each)]
    paths = " ".join(_quoted(each.path) for each in commands[1:])
    return _HEAD.format(paths=paths) + "\n".join(lines) + "\n"


def _command(command: CommandWords) -> Iterator[str]:
    start = f"complete -c mav -n {_quoted(f'__mav_at {command.path}')}"
    for word, summary in command.words:
        yield f"{start} -a {_quoted(word)}{_description(summary)}"
    if command.files:
        yield f"{start} -F"
    for option in command.options:
        yield f"{start} {_option(option)}"


def _option(option: OptionWords) -> str:
    names = " ".join(
        f"-l {_quoted(name[2:])}" if name.startswith("--") else f"-s {_quoted(name[1:])}"
        for name in option.names
    )
    if not option.takes_value:
        values = ""
    elif option.files:
        values = " -r -F"
    else:
        values = f" -x -a {_quoted(' '.join(option.choices))}" if option.choices else " -x"
    return f"{names}{values}{_description(option.summary)}"


def _description(summary: str) -> str:
    return f" -d {_quoted(summary)}" if summary else ""


def _quoted(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"
