"""`mav completion`: print a script with which a shell completes the commands of `mav`.

The script holds all words, so that completing needs no start of Python. It is written again after an update.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import echo_text
from mavstack.cli.completion import bash, fish, zsh
from mavstack.cli.completion.command_words import all_words

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Mapping, Sequence

    from mavstack.cli.completion.command_words import CommandWords

EXAMPLES: Final = """\
examples:
  mav completion bash > ~/.local/share/bash-completion/completions/mav
  mav completion zsh > ~/.zfunc/_mav                # a directory of fpath
  mav completion fish > ~/.config/fish/completions/mav.fish

For the current bash or zsh only: eval "$(mav completion bash)"
"""

#: The function that makes the script of each shell.
SHELLS: Final[Mapping[str, Callable[[Sequence[CommandWords]], str]]] = MappingProxyType(
    {"bash": bash.script, "zsh": zsh.script, "fish": fish.script}
)


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    parser.add_argument("shell", choices=tuple(SHELLS), help="the shell that runs the script")


def run(arguments: Namespace) -> int:
    """Run `mav completion`."""
    echo_text(SHELLS[arguments.shell](all_words()))
    return 0
