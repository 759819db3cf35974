"""`mav firmware`: show firmware files and boards, and flash them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.actions import Actions
from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.firmware.flash_progress import FlashProgress
from mavstack.cli.firmware.text import board_lines, file_lines, result_lines
from mavstack.flashing import FlashOptions, flash_firmware, list_ports, read_firmware
from mavstack.flashing.board_flasher import BoardFlasher
from mavstack.flashing.json_text import board_json, file_json, result_json
from mavstack.flashing.ports import has_modem_manager

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.flashing.ports import PortInfo

EXAMPLES: Final = """\
examples:
  mav firmware list                                        # boards at the ports of this machine
  mav firmware info px4_fmu-v5_default.px4                 # board, size and version of a file
  mav firmware info --port /dev/ttyACM0                    # a board in its bootloader
  mav firmware flash arducopter.apj --port /dev/ttyACM0 --dry-run   # check everything, write nothing
  mav firmware flash arducopter.apj --port /dev/ttyACM0
  mav firmware flash px4_fmu-v5_default.px4                # the only board that is plugged in
  mav firmware flash arducopter.abin --port udpin://0.0.0.0:14550   # by the SD card of an ArduPilot board
  mav firmware flash radio~hm_trp.ihx --port /dev/ttyUSB0 --port /dev/ttyUSB1   # both radios of a pair
  mav firmware flash betaflight_4.5.1_STM32F405.hex --port /dev/ttyACM0   # needs dfu-util
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the actions."""
    actions = Actions(parser, "firmware", EXAMPLES)
    action = actions.add("info", "show a firmware file, or a board in its bootloader", info)
    action.add_argument("file", nargs="?", metavar="FILE", help="firmware file")
    _add_port(action, "serial port of a board in its bootloader, or a URL")
    action.add_argument("--json", action="store_true", help="print JSON")
    action = actions.add("list", "list the serial ports with the boards at them", list_all)
    action.add_argument("--json", action="store_true", help="print JSON")
    action = actions.add("flash", "check a firmware, and write it to a board or a radio", flash)
    action.add_argument("file", metavar="FILE", help=".px4, .apj, .abin, .hex, .ihx, or .bin of an ESP32")
    action.add_argument(
        "--port",
        dest="ports",
        action="append",
        default=[],
        metavar="PORT|URL",
        help="serial port, or a URL; repeated for both radios of a pair (default: the only known board)",
    )
    action.add_argument("--dry-run", action="store_true", help="check everything, and write nothing")
    action.add_argument(
        "--no-backup", action="store_true", help="do not save the parameters before and restore them after"
    )
    action.add_argument(
        "--board", metavar="NAME", help="board of a radio, if the name of its file does not say"
    )
    action.add_argument("--json", action="store_true", help="print JSON")


def info(arguments: Namespace) -> int:
    """Run `mav firmware info`."""
    if (arguments.file is None) == (arguments.port is None):
        raise UsageError("give a FILE or --port PORT")
    if arguments.file is not None:
        firmware = read_firmware(arguments.file)
        if arguments.json:
            echo_json(file_json(firmware))
        else:
            echo(*file_lines(firmware))
        return 0
    return run_until_signal(_board_info(arguments))


def list_all(arguments: Namespace) -> int:
    """Run `mav firmware list`."""
    found = list_ports()
    if arguments.json:
        names = ("device", "board", "description", "usb", "serial", "in_bootloader")
        echo_json([{name: getattr(each, name) for name in names} for each in found])
        return 0
    if not found:
        echo("this machine has no serial ports now")
    rows = [
        (each.device, each.usb, each.board or each.description, "in its bootloader" * each.in_bootloader)
        for each in found
    ]
    echo(*align_columns(rows))
    return 0


def flash(arguments: Namespace) -> int:
    """Run `mav firmware flash`."""
    return run_until_signal(_flash(arguments))


async def _board_info(arguments: Namespace) -> int:
    board = await BoardFlasher(arguments.port, FlashOptions()).identify()
    if board is None:
        raise CommandError(
            f"{arguments.port}: no bootloader answers; unplug the board, plug it in again, "
            "and repeat the command within five seconds"
        )
    if arguments.json:
        echo_json(board_json(board))
    else:
        echo(*board_lines(board))
    return 0


async def _flash(arguments: Namespace) -> int:
    firmware = read_firmware(arguments.file)
    ports = arguments.ports or [_only_board()]
    if has_modem_manager():
        echo("mav firmware: ModemManager is installed, and may disturb the bootloader", error=True)
    if len(ports) > 1:  # all boards are checked before the first one is erased
        for port in ports:
            await flash_firmware(firmware, port, FlashOptions(dry_run=True, radio_board=arguments.board))
    for port in ports:
        with FlashProgress() as progress:
            options = FlashOptions(
                dry_run=arguments.dry_run,
                keep_parameters=not arguments.no_backup,
                radio_board=arguments.board,
                report=progress,
            )
            result = await flash_firmware(firmware, port, options)
        if arguments.json:
            echo_json({"port": port, **result_json(result, dry_run=arguments.dry_run)})
        else:
            echo(*result_lines(result, dry_run=arguments.dry_run))
    return 0


def _only_board() -> str:
    """Return the port of the only board that is known by its USB ids."""
    found = [port for port in list_ports() if port.board]
    if len(found) != 1:
        names = ", ".join(_described(port) for port in found)
        reason = f"several boards are plugged in: {names}" if found else "no known board is plugged in"
        raise CommandError(f"{reason}; name one by --port")
    return found[0].device


def _described(port: PortInfo) -> str:
    return f"{port.device} ({port.board})"


def _add_port(parser: ArgumentParser, text: str) -> None:
    parser.add_argument("--port", metavar="PORT|URL", help=text)
