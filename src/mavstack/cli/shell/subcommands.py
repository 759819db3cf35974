"""Commands of `mav` in the shell: the same words, options and output, on the session's vehicle."""

from __future__ import annotations

from argparse import RawDescriptionHelpFormatter
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.session_parser import SessionParser
from mavstack.cli.registry import load_command
from mavstack.cli.shell.console_command import AlreadyReported

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Sequence

    from mavstack.cli.shell.session import Session
    from mavstack.vehicle import Vehicle


async def run_subcommand(session: Session, name: str, words: Sequence[str]) -> None:
    """Run `mav NAME WORDS…` on the vehicle of the session.

    Raises:
        UsageError: The words are wrong.
        MavstackError: The command failed.
    """
    parser = SessionParser(prog=name, formatter_class=RawDescriptionHelpFormatter, allow_abbrev=False)
    load_command(name).add_arguments(parser)
    work: list[Callable[[Vehicle], Awaitable[int]]] = []
    defaults: dict[str, Any] = {"session_work": work.append, "ask": session.ask}
    parser.set_defaults(**defaults)
    try:
        arguments = parser.parse_args(list(words))
    except SystemExit:  # argparse has printed its help
        return
    code = arguments.run_action(arguments)
    for each in work:
        code = code or await each(session.vehicle)
    if code:
        raise AlreadyReported(f"{name} failed")
