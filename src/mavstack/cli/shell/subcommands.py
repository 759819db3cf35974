"""Commands of `mav` in the shell: the same words, options and output, for the vehicle that is at hand."""

from __future__ import annotations

from argparse import RawDescriptionHelpFormatter
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol, cast

from mavstack.cli.common.connection import AtHand
from mavstack.cli.shell.console_command import AlreadyTold

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Awaitable, Callable, Sequence

    from mavstack.cli.shell.session import Session
    from mavstack.vehicle import Vehicle


class _Module(Protocol):
    EXAMPLES: str

    def add_arguments(self, parser: ArgumentParser) -> None: ...
    def run(self, arguments: Namespace) -> int: ...


async def run_borrowed(session: Session, name: str, words: Sequence[str]) -> None:
    """Run `mav NAME WORDS…` on the vehicle of the session; raises what it raises."""
    handed: list[Callable[[Vehicle], Awaitable[int]]] = []
    module = cast("_Module", import_module(f"mavstack.cli.{name}.command"))
    parser = AtHand(prog=name, formatter_class=RawDescriptionHelpFormatter, allow_abbrev=False)
    module.add_arguments(parser)
    defaults: dict[str, Any] = {"hand_over": handed.append}
    parser.set_defaults(**defaults)
    try:
        arguments = parser.parse_args(list(words))
    except SystemExit:  # argparse has printed its help
        return
    code = module.run(arguments)
    for work in handed:
        code = code or await work(session.vehicle)
    if code:
        raise AlreadyTold(f"{name} failed")
