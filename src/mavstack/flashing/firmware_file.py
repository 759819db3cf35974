"""The content of a firmware file."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from mavstack.flashing.intel_hex import Segments

#: Maximum size of a file in bytes; the largest board has 2 MB of internal and 16 MB of external flash.
MAX_FILE_SIZE: Final = 64_000_000


class FirmwareKind(StrEnum):
    """The kind of a firmware file, which decides how it is flashed."""

    PX4 = "px4"
    APJ = "apj"
    ABIN = "abin"
    SIK = "sik"
    STM32 = "stm32"
    ESP32 = "esp32"


@dataclass(frozen=True, slots=True, kw_only=True)
class FirmwareFile:
    """A firmware file.

    Attributes:
        kind: Its kind.
        image: The bytes for the internal flash, a multiple of four; of .abin and .bin the whole file.
        external: The bytes for the external flash; empty if it has none.
        segments: The bytes by address, of an Intel HEX file.
        board_id: The board for which it was built; None if the file does not name it.
        max_size: The largest image for which the board's flash has room, by the file; None if not named.
        signed: True if the image has a signature, which the bootloader verifies.
        name: The board or the product, in words.
        version: The version or the git hash of the source.
        usb_ids: USB ids of the board that runs this firmware, as "0x1209/0x5740".
        properties: All other properties that the file has.
    """

    kind: FirmwareKind
    image: bytes = b""
    external: bytes = b""
    segments: Segments = ()
    board_id: int | None = None
    max_size: int | None = None
    signed: bool = False
    name: str = ""
    version: str = ""
    usb_ids: tuple[str, ...] = ()
    properties: dict[str, Any] | None = None

    @property
    def size(self) -> int:
        """Bytes that are written."""
        written = sum(len(data) for _, data in self.segments)
        return written or len(self.image) + len(self.external)
