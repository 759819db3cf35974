"""Flashing any device: the file decides how."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.flashing.board_flasher import BoardFlasher
from mavstack.flashing.external_tools import flash_esp32, flash_stm32
from mavstack.flashing.firmware_file import FirmwareKind
from mavstack.flashing.options import FlashOptions
from mavstack.flashing.radio_flasher import RadioFlasher
from mavstack.flashing.sd_card import flash_by_sd_card

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Mapping

    from mavstack.flashing.firmware_file import FirmwareFile
    from mavstack.flashing.result import FlashResult


async def flash_firmware(
    firmware: FirmwareFile, port: str, options: FlashOptions | None = None
) -> FlashResult:
    """Check everything, then write a firmware to the device at a port.

    Args:
        firmware: The firmware.
        port: A serial device such as /dev/ttyACM0, or a URL.
        options: The options; None: the default ones.

    Returns:
        The board, and what became of its parameters.

    Raises:
        FlashingRefused: The firmware does not fit, or the device cannot be flashed now; nothing was erased.
        FlashingError: Flashing failed; the text says what to do.
        LinkError: The port cannot be opened.
    """
    return await _FLASHERS[firmware.kind](firmware, port, options or FlashOptions())


async def _flash_board(firmware: FirmwareFile, port: str, options: FlashOptions) -> FlashResult:
    return await BoardFlasher(port, options).flash(firmware)


async def _flash_radio(firmware: FirmwareFile, port: str, options: FlashOptions) -> FlashResult:
    return await RadioFlasher(port, options).flash(firmware)


_FLASHERS: Final[
    Mapping[FirmwareKind, Callable[[FirmwareFile, str, FlashOptions], Awaitable[FlashResult]]]
] = MappingProxyType(
    {
        FirmwareKind.PX4: _flash_board,
        FirmwareKind.APJ: _flash_board,
        FirmwareKind.ABIN: flash_by_sd_card,
        FirmwareKind.SIK: _flash_radio,
        FirmwareKind.STM32: flash_stm32,
        FirmwareKind.ESP32: flash_esp32,
    }
)
