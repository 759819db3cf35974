"""The completion script for zsh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mavstack.cli.completion.command_words import CommandWords, OptionWords

_SCRIPT: Final = """\
#compdef mav
# Completion of mav in zsh. For all sessions, with ~/.zfunc in fpath before compinit:
#   mav completion zsh > ~/.zfunc/_mav
# or, after compinit in ~/.zshrc:
#   eval "$(mav completion zsh)"

_mav() {{
    local at=mav option="${{words[CURRENT-1]}}" files=
    local -a items choices
    integer i
    for ((i = 2; i < CURRENT; i++)); do
        case "$at ${{words[i]}}" in
            ({paths}) at="$at ${{words[i]}}" ;;
        esac
    done
    if [[ ${{words[CURRENT]}} == --*=* ]]; then
        option="${{words[CURRENT]%%=*}}"
        compset -P '*='
    fi
    case "$at $option" in
{values}
    esac
    if [[ ${{words[CURRENT]}} == -* ]]; then
        case "$at" in
{options}
        esac
        _describe -o 'option' items
        return
    fi
    case "$at" in
{words}
    esac
    (( ${{#items}} )) && _describe 'command' items
    [[ -n $files ]] && _files
}}

if [[ ${{funcstack[1]}} == _mav ]]; then
    _mav "$@"
else
    compdef _mav mav
fi
"""


def script(commands: Sequence[CommandWords]) -> str:
    """Return the script."""
    return _SCRIPT.format(
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
