"""The reference of `mav` as Markdown: every command, action, option and example, from the argument parsers.

`python -m mavstack.cli.reference` prints the whole reference; with names of commands, only theirs.
"""

# ruff: noqa: SLF001 (argparse has no public access to the options of a parser)

from __future__ import annotations

import sys
from argparse import SUPPRESS, ArgumentParser, HelpFormatter
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.log_output import LOGGING_GROUP, add_logging_options
from mavstack.cli.common.output import echo_text
from mavstack.cli.registry import COMMANDS, actions_of, command_parser

if TYPE_CHECKING:
    from argparse import Action, _ArgumentGroup
    from collections.abc import Iterator, Sequence

    from mavstack.cli.shell.session import Command

#: Columns at which usage lines are wrapped.
WIDTH: Final = 100
_INTRODUCTION: Final = """\
`mav` is one program with a command for each task. Every command has `--help`. The exit code is 0 for success,
1 for a failure told in one line on stderr, 2 for wrong usage, and 130 after Ctrl-C. Every command has these
options for its log:
"""
_HEADINGS: Final = {"positional": "argument", "options": "option", "vehicle": "vehicle option"}


def cli_reference(level: int = 1) -> str:
    """Render the reference of all commands.

    Args:
        level: Level of the topmost heading.

    Returns:
        Markdown.
    """
    parts = [f"{'#' * level} Commands of mav", _INTRODUCTION.rstrip(), _logging_table(), _command_table()]
    parts += [command_reference(name, level + 1) for name in COMMANDS]
    parts.append(shell_reference(level + 1))
    return "\n\n".join(parts) + "\n"


def command_reference(name: str, level: int = 1) -> str:
    """Render the reference of one command and its actions.

    Args:
        name: Name of the command, a key of `mavstack.cli.registry.COMMANDS`.
        level: Level of the command's heading; actions are one level below.

    Returns:
        Markdown.
    """
    parser = command_parser(name)
    parts = [f"{'#' * level} mav {name}", *_parser_parts(parser, with_options=not actions_of(parser))]
    for action, summary, action_parser in actions_of(parser):
        parts += [f"{'#' * (level + 1)} mav {name} {action}", f"{_sentence(summary)}"]
        parts += _parser_parts(action_parser, with_description=False)
    return "\n\n".join(parts)


def shell_reference(level: int = 1) -> str:
    """Render the reference of the commands inside `mav shell`.

    Args:
        level: Level of the heading; the shell's commands are one level below.

    Returns:
        Markdown.
    """
    from mavstack.cli.shell.registry import COMMANDS as SHELL_COMMANDS

    parts = [f"{'#' * level} Commands inside mav shell"]
    for command in dict.fromkeys(SHELL_COMMANDS.values()):
        parts += [f"{'#' * (level + 1)} {command.name}", *_shell_command_parts(command)]
    return "\n\n".join(parts)


def _command_table() -> str:
    rows = [f"| [`mav {name}`](#mav-{name}) | {_cell(entry.summary)} |" for name, entry in COMMANDS.items()]
    return "\n".join(["| command | purpose |", "|---|---|", *rows])


def _logging_table() -> str:
    parser = ArgumentParser()
    add_logging_options(parser)
    return _table(parser, parser._action_groups[-1])


def _parser_parts(
    parser: ArgumentParser, *, with_description: bool = True, with_options: bool = True
) -> Iterator[str]:
    """Yield the description, the usage, the tables of arguments and options, and the examples."""
    if with_description and parser.description:
        yield parser.description
    yield f"```text\n{_usage(parser)}\n```"
    if with_options:
        yield from _argument_tables(parser)
    if parser.epilog:
        yield from _epilog_parts(parser.epilog)


def _usage(parser: ArgumentParser) -> str:
    formatter = HelpFormatter(prog=parser.prog, width=WIDTH)
    formatter.add_usage(parser.usage, parser._actions, parser._mutually_exclusive_groups, prefix="")
    return formatter.format_help().strip()


def _argument_tables(parser: ArgumentParser) -> Iterator[str]:
    for group in parser._action_groups:
        if group.title != LOGGING_GROUP and any(map(_is_documented, group._group_actions)):
            yield _table(parser, group)


def _table(parser: ArgumentParser, group: _ArgumentGroup) -> str:
    heading = (group.title or "options").split()[0]
    actions = [each for each in group._group_actions if _is_documented(each)]
    rows = [f"| {_cell(_invocation(each))} | {_cell(_help(parser, each))} |" for each in actions]
    return "\n".join([f"| {_HEADINGS.get(heading, 'option')} | meaning |", "|---|---|", *rows])


def _is_documented(action: Action) -> bool:
    return action.help != SUPPRESS and "--help" not in action.option_strings


def _invocation(action: Action) -> str:
    metavar = action.metavar if isinstance(action.metavar, str) else ""
    if not metavar and action.choices is not None:
        metavar = "{" + ",".join(map(str, action.choices)) + "}"
    if not action.option_strings:
        return f"`{metavar or action.dest}`"
    takes_value = action.nargs != 0
    value = f" {metavar or action.dest.upper()}" if takes_value else ""
    return ", ".join(f"`{option}{value}`" for option in action.option_strings)


def _help(parser: ArgumentParser, action: Action) -> str:
    return HelpFormatter(prog=parser.prog)._expand_help(action) if action.help else ""


def _epilog_parts(epilog: str) -> Iterator[str]:
    """Yield the paragraphs of an epilog, with indented lines as code blocks."""
    for paragraph in epilog.strip().split("\n\n"):
        head, *lines = paragraph.splitlines()
        if lines and all(line.startswith("  ") for line in lines):
            code = "\n".join(line.removeprefix("  ") for line in lines)
            yield f"{_sentence(head.rstrip(':'), end=':')}\n\n```sh\n{code}\n```"
        elif head.rstrip(":") != "examples":
            yield "\n".join([head, *lines])


def _shell_command_parts(command: Command) -> Iterator[str]:
    yield _sentence(command.summary)
    yield f"```text\n{command.synopsis}\n```"
    if command.details:
        yield command.details
    if command.aliases:
        yield f"Other names: {', '.join(f'`{alias}`' for alias in command.aliases)}."
    if command.examples:
        yield "Examples:\n\n```text\n" + "\n".join(command.examples) + "\n```"


def _sentence(text: str, end: str = ".") -> str:
    return text[:1].upper() + text[1:].rstrip(".") + end


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def main(names: Sequence[str]) -> None:
    """Print the reference of the named commands, or of all."""
    echo_text("\n\n".join(map(command_reference, names)) + "\n" if names else cli_reference())


if __name__ == "__main__":
    main(sys.argv[1:])
