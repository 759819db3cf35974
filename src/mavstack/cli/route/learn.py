"""`mav route learn`: the rules of a firewall from a recorded flight."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.atomic_file import write_file_atomically
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.output import echo, echo_text
from mavstack.dialects import Dialect
from mavstack.router.firewall.learn import RuleLearner
from mavstack.wire import Parser

if TYPE_CHECKING:
    from argparse import Namespace

#: Number of bytes of the log that are read at a time.
_CHUNK = 1 << 20


def learn(words: list[str], arguments: Namespace) -> int:
    """Run `mav route learn LOG`.

    Args:
        words: The words after `learn`.
        arguments: The arguments of the command.
    """
    if len(words) != 1:
        raise UsageError("learn needs one recording (.tlog, or raw packets)")
    learner = RuleLearner()
    try:
        _read(words[0], learner)
        text = learner.toml(Path(words[0]).name)
        if arguments.output and learner.senders:
            write_file_atomically(arguments.output, text)
    except OSError as error:
        raise CommandError(f"cannot open {error.filename}: {error.strerror or error}") from None
    if not learner.senders:
        raise CommandError(f"{words[0]} has no MAVLink packets")
    if arguments.output:
        echo(f"{arguments.output}: rules for {learner.senders} senders; a dry run until you remove dry_run")
    else:
        echo_text(text)
    return 0


def _read(path: str, learner: RuleLearner) -> None:
    """Read the packets of a file: a tlog, or packets alone, whichever gives more packets at its beginning."""
    dialect = Dialect.load("all")
    with Path(path).open("rb") as file:
        head = file.read(_CHUNK)
        counts = [len(Parser(dialect, timestamped=each).feed(head)) for each in (False, True)]
        parser = Parser(dialect, timestamped=counts[True] > counts[False])
        while head:
            learner.add(parser.feed(head))
            head = file.read(_CHUNK)
