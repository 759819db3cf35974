"""A board as its bootloader describes it, and the checks of a firmware before anything is erased."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.flashing.failures import FlashingRefused

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.flashing.firmware_file import FirmwareFile

#: Supported protocol revisions of bootloaders.
MIN_REVISION, MAX_REVISION = 2, 6
#: Minimum protocol revision of a bootloader that reports its chip.
CHIP_REVISION: Final = 5
#: Ids of other boards whose firmware also runs on a board, by the id of the board.
COMPATIBLE: Final[Mapping[int, frozenset[int]]] = MappingProxyType({33: frozenset({9})})
#: Board names by id, for texts; a bootloader reports only the id.
NAMES: Final[Mapping[int, str]] = MappingProxyType(
    {
        9: "Pixhawk 1 (FMUv2, FMUv3)",
        11: "Pixracer (FMUv4)",
        33: "AUAV-X2.1",
        50: "Pixhawk 4 (FMUv5)",
        51: "FMUv5X",
        53: "FMUv6X",
        56: "FMUv6C",
        57: "FMUv6U",
        140: "CubeOrange",
        1063: "CubeOrangePlus",
    }
)
#: Id of the chip family STM32F42x, and its revisions whose second megabyte of flash cannot be used.
_F42X: Final = 0x419
_FLAWED: Final = frozenset({0x1000, 0x1001, 0x1003, 0x1007})
_FAMILY_MASK: Final = 0xFFF
#: Flash size of such a chip for the firmware in bytes: one megabyte without 16 kB for the bootloader.
FLAWED_SIZE: Final = 1_032_192
_PIXHAWK: Final = 9


@dataclass(frozen=True, slots=True, kw_only=True)
class Board:
    """A board in its bootloader.

    Attributes:
        bootloader: The protocol revision of the bootloader.
        board_id: The number of the board.
        board_revision: Its revision.
        flash_size: Bytes of internal flash for a firmware.
        external_size: Bytes of external flash; 0 if it has none.
        chip: The id of the chip, with its revision in the upper half; None if the bootloader does not tell.
        chip_name: Family and revision of the chip, in words; empty if the bootloader does not tell.
        serial: The serial number of the chip as hexadecimal text; empty if the bootloader does not tell.
        version: The version of the bootloader; empty if it does not tell.
    """

    bootloader: int
    board_id: int
    board_revision: int
    flash_size: int
    external_size: int = 0
    chip: int | None = None
    chip_name: str = ""
    serial: str = ""
    version: str = ""

    @property
    def name(self) -> str:
        """The name of the board, or its number."""
        name = NAMES.get(self.board_id)
        return f"board {self.board_id}" + (f", {name}" if name else "")

    @property
    def usable_size(self) -> int:
        """Bytes of internal flash that can be used: a flawed STM32F42x has one megabyte."""
        flawed = (
            self.chip is not None and self.chip & _FAMILY_MASK == _F42X and self.chip >> 16 in _FLAWED
        ) or (self.bootloader < CHIP_REVISION and self.board_id == _PIXHAWK)
        return min(self.flash_size, FLAWED_SIZE) if flawed else self.flash_size


def check_board_id(firmware: FirmwareFile, board_id: int, name: str) -> None:
    """Refuse a firmware of another board.

    Args:
        firmware: The firmware.
        board_id: The number of the board.
        name: The board as errors name it.

    Raises:
        FlashingRefused: The firmware is for another board.
    """
    accepted = {board_id} | COMPATIBLE.get(board_id, frozenset())
    if firmware.board_id not in accepted:
        other = NAMES.get(firmware.board_id or 0)
        built = f"board {firmware.board_id}" + (f", {other}" if other else "")
        raise FlashingRefused(
            f"flashing {name} failed: the firmware is for {built}; get the file for board {board_id}"
        )


def check_firmware(firmware: FirmwareFile, board: Board) -> None:
    """Refuse a firmware that does not fit a board; nothing is sent.

    Args:
        firmware: The firmware, of kind PX4 or APJ.
        board: The board.

    Raises:
        FlashingRefused: It is for another board, too large, or the bootloader is of an unknown revision.
    """
    where = f"flashing {board.name} failed"
    if not MIN_REVISION <= board.bootloader <= MAX_REVISION:
        raise FlashingRefused(
            f"{where}: its bootloader speaks revision {board.bootloader} of the protocol, "
            f"known are {MIN_REVISION} to {MAX_REVISION}"
        )
    check_board_id(firmware, board.board_id, board.name)
    size = len(firmware.image)
    if size > board.usable_size:
        reason = (
            "" if board.usable_size == board.flash_size else "; its chip cannot use the rest of its flash"
        )
        raise FlashingRefused(
            f"{where}: the firmware has {size} bytes, the board {board.usable_size}{reason}"
        )
    if firmware.max_size is not None and size > firmware.max_size + -firmware.max_size % 4:
        raise FlashingRefused(f"{where}: the firmware has {size} bytes, its file allows {firmware.max_size}")
    if len(firmware.external) > board.external_size:
        raise FlashingRefused(
            f"{where}: the firmware has {len(firmware.external)} bytes of external flash, "
            f"the board {board.external_size}"
        )
