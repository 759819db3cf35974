"""`mav sim --bootloader px4`: a board in its bootloader, which starts an autopilot once it is flashed."""

from __future__ import annotations

import asyncio
from argparse import ArgumentTypeError
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.output import echo, echo_json

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

#: Where uploaders find the board.
DEFAULT_OUT: Final = "pty:///tmp/ttyBL"
_FIRMWARES: Final = ("px4", "ardupilot")
_MAX_BOARD: Final = 0xFFFF


def add_bootloader_option(parser: ArgumentParser) -> None:
    """Declare `--bootloader`."""
    parser.add_argument(
        "--bootloader",
        type=bootloader,
        metavar="NAME[:BOARD]",
        help=f"a board without firmware, in the bootloader of px4 or ardupilot (default link: {DEFAULT_OUT})",
    )


def bootloader(text: str) -> tuple[str, int | None]:
    """Parse a bootloader with the number of its board; raises ArgumentTypeError."""
    name, _, number = text.lower().partition(":")
    if name not in _FIRMWARES or (number and not (number.isdecimal() and 0 < int(number) <= _MAX_BOARD)):
        raise ArgumentTypeError(f"{text!r} is not px4 or ardupilot, with the number of a board such as px4:9")
    return name, int(number) if number else None


async def simulate_board(arguments: Namespace) -> int:
    """Run the board until the time is over."""
    from mavstack.flashing.simulated_board import SimulatedBoard
    from mavstack.flashing.simulated_bootloader import board_of
    from mavstack.flashing.simulated_port import SimulatedPort

    urls = arguments.out or [DEFAULT_OUT]
    if len(urls) != 1:
        raise UsageError("--bootloader: a board has one port; give --out once")
    firmware, number = arguments.bootloader
    board = SimulatedBoard(firmware, board_of(firmware, number))
    as_json = arguments.json
    board.listeners.append(
        lambda text: echo_json({"event": "board", "text": text}) if as_json else echo(text)
    )
    async with SimulatedPort(board, urls[0]) as port:
        facts = board.bootloader.board
        if as_json:
            links = [port.link.url.redacted]
            echo_json({"event": "ready", "board": facts.board_id, "flash": facts.flash_size, "links": links})
        else:
            echo(f"{facts.name}: bootloader of {firmware}, {facts.flash_size} bytes of flash, no firmware")
            echo(f"on {port.link.url.redacted}")
        announce_exposure("sim", [port.link])
        await asyncio.sleep(arguments.seconds if arguments.seconds is not None else float("inf"))
    return 0
