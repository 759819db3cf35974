"""Firmware for autopilots and radios: files, bootloaders, and the procedure that writes one to the other.

    from mavstack.flashing import flash_firmware, read_firmware

    await flash_firmware(read_firmware("arducopter.apj"), "/dev/ttyACM0")

Everything is checked before anything is erased; the parameters are saved before and restored after.
"""

from mavstack.flashing.board import Board
from mavstack.flashing.failures import BootloaderError, FirmwareFileError, FlashingError, FlashingRefused
from mavstack.flashing.firmware_file import FirmwareFile, FirmwareKind
from mavstack.flashing.firmware_reader import parse_firmware, read_firmware
from mavstack.flashing.flasher import flash_firmware
from mavstack.flashing.options import FlashOptions
from mavstack.flashing.ports import PortInfo, list_ports
from mavstack.flashing.progress import Phase
from mavstack.flashing.result import FlashResult

__all__ = [
    "Board",
    "BootloaderError",
    "FirmwareFile",
    "FirmwareFileError",
    "FirmwareKind",
    "FlashOptions",
    "FlashResult",
    "FlashingError",
    "FlashingRefused",
    "Phase",
    "PortInfo",
    "flash_firmware",
    "list_ports",
    "parse_firmware",
    "read_firmware",
]
