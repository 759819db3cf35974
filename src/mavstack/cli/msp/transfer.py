"""`mav msp dump` and `mav msp restore`: all settings of a flight controller as text."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Final

from mavstack.atomic_file import write_file_atomically
from mavstack.bounded_file import read_file_bounded
from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.output import echo, echo_json, echo_text
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.msp.connection import run_on_controller
from mavstack.msp.cli import restore_lines

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.bridges.msp.flight_controller import FlightController

#: Maximum size of a file with settings in bytes; a dump has less than 100,000.
MAX_FILE: Final = 4 << 20


def dump(arguments: Namespace) -> int:
    """Run `mav msp dump`."""

    async def work(controller: FlightController) -> int:
        async with controller.cli() as session:
            text = await session.dump("dump all" if arguments.full else "diff all")
            _write(arguments, text)
        return 0

    return run_on_controller(arguments, work)


def restore(arguments: Namespace) -> int:
    """Run `mav msp restore`."""
    text = _read(arguments.file)
    if not restore_lines(text):
        raise CommandError(f"cannot restore {arguments.file}: it has no commands")

    async def work(controller: FlightController) -> int:
        with TransferProgress("restoring", in_bytes=False) as progress:
            count = await controller.restore(text, progress)
        if arguments.json:
            echo_json({"file": arguments.file, "commands": count})
        else:
            echo(f"{count} commands of {arguments.file} applied and saved")
        return 0

    return run_on_controller(arguments, work)


def _write(arguments: Namespace, text: str) -> None:
    if arguments.file in (None, "-"):
        if arguments.json:
            echo_json({"dump": text})
        else:
            echo_text(text)
        return
    write_file_atomically(arguments.file, text)
    lines = len(restore_lines(text))
    if arguments.json:
        echo_json({"file": arguments.file, "commands": lines})
    else:
        echo(f"{lines} commands saved to {arguments.file}")


def _read(name: str) -> str:
    if name == "-":
        return sys.stdin.read(MAX_FILE)
    try:
        return read_file_bounded(name, MAX_FILE).decode("ascii")
    except UnicodeDecodeError:
        raise CommandError(
            f"cannot read {name}: it is no dump, since it has characters beyond ASCII"
        ) from None
