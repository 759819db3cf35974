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

#: The port on which upload programs find the simulated board.
DEFAULT_OUT: Final = "pty:///tmp/ttyBL"
_FIRMWARES: Final = ("px4", "ardupilot")
#: The simulation of the ROM bootloader of an STM32 chip, for stm32flash and similar programs.
_ROM: Final = "stm32"
_MAX_BOARD: Final = 0xFFFF


def add_bootloader_option(parser: ArgumentParser) -> None:
    """Declare `--bootloader`."""
    parser.add_argument(
        "--bootloader",
        type=bootloader,
        metavar="NAME[:BOARD]",
        help=f"a board without firmware, in the bootloader of px4 or ardupilot, or in the ROM of an stm32 "
        f"(default link: {DEFAULT_OUT})",
    )


def bootloader(text: str) -> tuple[str, int | None]:
    """Parse a bootloader with the number of its board; raises ArgumentTypeError."""
    name, _, number = text.lower().partition(":")
    if text.lower() == _ROM:
        return name, None
    if name not in _FIRMWARES or (number and not (number.isdecimal() and 0 < int(number) <= _MAX_BOARD)):
        raise ArgumentTypeError(
            f"{text!r} is not px4, ardupilot or stm32, with the number of a board such as px4:9"
        )
    return name, int(number) if number else None


async def simulate_board(arguments: Namespace) -> int:
    """Run the board until the time is over."""
    from mavstack.flashing.simulated_board import SimulatedBoard
    from mavstack.flashing.simulated_bootloader import board_of
    from mavstack.flashing.simulated_port import SimulatedPort
    from mavstack.flashing.simulated_rom import CHIP_ID, FLASH_SIZE, SimulatedRom

    urls = arguments.out or [DEFAULT_OUT]
    if len(urls) != 1:
        raise UsageError("--bootloader: a board has one port; give --out once")
    firmware, number = arguments.bootloader
    as_json = arguments.json

    def emit(text: str) -> None:
        echo_json({"event": "board", "text": text}) if as_json else echo(text)

    board: SimulatedBoard | SimulatedRom
    if firmware == _ROM:
        board = SimulatedRom()
        board.on_event = emit
        name, number, size = "STM32F405 in its ROM", CHIP_ID, FLASH_SIZE
    else:
        board = SimulatedBoard(firmware, board_of(firmware, number))
        board.listeners.append(emit)
        facts = board.bootloader.board
        name, number, size = f"{facts.name}: bootloader of {firmware}", facts.board_id, facts.flash_size
    async with SimulatedPort(board, urls[0]) as port:
        if as_json:
            echo_json({"event": "ready", "board": number, "flash": size, "links": [port.link.url.redacted]})
        else:
            echo(f"{name}, {size} bytes of flash, no firmware")
            echo(f"on {port.link.url.redacted}")
        announce_exposure("sim", [port.link])
        await asyncio.sleep(arguments.seconds if arguments.seconds is not None else float("inf"))
    return 0
