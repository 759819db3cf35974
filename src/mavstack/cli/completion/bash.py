"""The completion script for bash, from version 3.2 on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mavstack.cli.completion.command_words import CommandWords

_SCRIPT: Final = """\
# Completion of mav in bash. For all sessions:
#   mav completion bash > ~/.local/share/bash-completion/completions/mav
# or, without bash-completion, in ~/.bashrc:
#   eval "$(mav completion bash)"

_mav() {{
    local current="${{COMP_WORDS[COMP_CWORD]}}" option="${{COMP_WORDS[COMP_CWORD-1]}}"
    local path=mav words= files= i IFS=$' \\t\\n'
    if [[ $current == "=" ]]; then  # bash splits --option=value into three words
        current=
    elif [[ $option == "=" ]]; then
        option="${{COMP_WORDS[COMP_CWORD-2]}}"
    fi
    for ((i = 1; i < COMP_CWORD; i++)); do
        case "$path ${{COMP_WORDS[i]}}" in
            {paths}) path="$path ${{COMP_WORDS[i]}}" ;;
        esac
    done
    case "$path $option" in
{values}
        *)
            if [[ $current == -* ]]; then
                case "$path" in
{options}
                esac
            else
                case "$path" in
{words}
                esac
            fi ;;
    esac
    COMPREPLY=($(compgen -W "$words" -- "$current"))
    if [[ $files ]]; then
        IFS=$'\\n'
        COMPREPLY+=($(compgen -f -- "$current"))
        compopt -o filenames 2>/dev/null
    fi
}}
complete -F _mav mav
"""


def script(commands: Sequence[CommandWords]) -> str:
    """Return the script."""
    return _SCRIPT.format(
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
