"""Reading of firmware files, which are recognised by their content.

.px4, .apj     JSON with the image, compressed, and the board that it is for
.abin          ArduPilot's image for its bootloader, which finds it on the SD card; with an MD5 sum
.hex, .ihx     Intel HEX: Betaflight, iNav, "with bootloader" builds, SiK radios
.bin           an image of an ESP32
"""

from __future__ import annotations

from os import fspath
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.flashing.abin import ABIN_START, parse_abin
from mavstack.flashing.failures import FirmwareFileError
from mavstack.flashing.firmware_file import MAX_FILE_SIZE, FirmwareFile, FirmwareKind
from mavstack.flashing.intel_hex import parse_intel_hex
from mavstack.flashing.json_container import parse_container

if TYPE_CHECKING:
    from os import PathLike

#: The first byte of an ESP32 image.
_ESP_MAGIC: Final = 0xE9
_HEX_START: Final = b":"
#: Number of flash addresses of a SiK radio: its Intel HEX files have 16-bit addresses.
_SIK_ADDRESSES: Final = 0x10000


def read_firmware(path: str | PathLike[str]) -> FirmwareFile:
    """Read a firmware file.

    Args:
        path: The file: .px4, .apj, .abin, .hex, .ihx, or .bin of an ESP32.

    Returns:
        The firmware.

    Raises:
        FirmwareFileError: The file is damaged, or of an unknown format.
        OSError: The file cannot be read.
    """
    with Path(path).open("rb") as file:
        data = file.read(MAX_FILE_SIZE + 1)
    return parse_firmware(data, fspath(path))


def parse_firmware(data: bytes, name: str = "firmware") -> FirmwareFile:
    """Parse the content of a firmware file.

    Args:
        data: The content.
        name: The name of the file, for errors and for the board of a radio.

    Returns:
        The firmware.

    Raises:
        FirmwareFileError: The content is damaged, or of an unknown format.
    """
    if not data:
        raise FirmwareFileError("the file is empty", name)
    if len(data) > MAX_FILE_SIZE:
        raise FirmwareFileError(f"more than {MAX_FILE_SIZE // 1_000_000} MB, no firmware is that large", name)
    if data.lstrip()[:1] == b"{":
        return parse_container(data, name)
    if data.startswith(ABIN_START):
        return parse_abin(data, name)
    if data.lstrip()[:1] == _HEX_START:
        return _of_hex(data, name)
    if data[0] == _ESP_MAGIC:
        return FirmwareFile(kind=FirmwareKind.ESP32, image=data, name="ESP32")
    raise FirmwareFileError("not a firmware file (.px4, .apj, .abin, .hex, .ihx, .bin of an ESP32)", name)


def _of_hex(data: bytes, name: str) -> FirmwareFile:
    segments = parse_intel_hex(data, name)
    is_radio = max(start + len(part) for start, part in segments) <= _SIK_ADDRESSES
    kind = FirmwareKind.SIK if is_radio else FirmwareKind.STM32
    return FirmwareFile(kind=kind, segments=segments, name=Path(name).stem)
