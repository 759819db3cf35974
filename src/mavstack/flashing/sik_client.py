"""The bootloader of SiK radios, seen by a program.

It is a relative of that of PX4: LOAD_ADDRESS sets the place, blocks have at most 32 bytes, and the flash is
read back, since there is no CRC. REBOOT has no end and no answer. Source: the uploader of SiK.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.flashing.conversation import Request, Steps, fixed
from mavstack.flashing.failures import BootloaderError, FlashingRefused
from mavstack.flashing.progress import Phase, ReportProgress, no_progress

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.flashing.firmware_file import FirmwareFile

END: Final = 0x20
SYNC, DEVICE, ERASE, ADDRESS, PROGRAM, READ, REBOOT = 0x21, 0x22, 0x23, 0x24, 0x27, 0x28, 0x30
#: Size of a written block, and of a read block, in bytes; longer ones hang some USB adapters.
WRITE_SIZE, READ_SIZE = 32, 128
#: Bytes that complete an interrupted request.
_PADDING: Final = bytes(WRITE_SIZE + 2)
_ATTEMPTS: Final = 3
_ERASE_TIMEOUT: Final = 15.0
#: Board ids by the board name in names of firmware files, such as `radio~hm_trp.ihx`.
BOARDS: Final[Mapping[str, int]] = MappingProxyType(
    {"rfd900": 0x42, "rfd900a": 0x43, "rf50": 0x4D, "hm_trp": 0x4E}
)
BANDS: Final[Mapping[int, int]] = MappingProxyType({0x43: 433, 0x47: 470, 0x86: 868, 0x91: 915})
_BOARD_MASK: Final = 0x7F


@dataclass(frozen=True, slots=True)
class RadioBoard:
    """A radio in its bootloader: the number of its board, and the code of its band."""

    board: int
    frequency: int

    @property
    def name(self) -> str:
        """The radio in words."""
        names = {number: name for name, number in BOARDS.items()}
        band = BANDS.get(self.frequency)
        known = names.get(self.board & _BOARD_MASK, f"board {self.board:#x}")
        return f"radio {known}" + (f", {band} MHz" if band else "")


def board_of_file(firmware: FirmwareFile, name: str | None = None) -> int:
    """Return the board for which a firmware of a radio is.

    Args:
        firmware: The firmware; the name of its file is such as `radio~hm_trp`.
        name: The name of the board, if the user gave it.

    Returns:
        The number of the board.

    Raises:
        FlashingRefused: Neither names a board that is known.
    """
    words = name if name is not None else firmware.name.rpartition("~")[2]
    found = BOARDS.get(words.lower().replace("-", "_"))
    if found is None:
        known = ", ".join(BOARDS)
        raise FlashingRefused(
            f"flashing a radio failed: {words!r} is not the name of a board; add --board with one of {known}"
        )
    return found


def check_radio(firmware: FirmwareFile, board: RadioBoard, name: str | None) -> None:
    """Refuse the firmware of another radio; nothing is sent."""
    wanted = board_of_file(firmware, name)
    if wanted != board.board & _BOARD_MASK:
        other = RadioBoard(wanted, 0).name
        raise FlashingRefused(f"flashing {board.name} failed: the firmware is for {other}")


def identify(attempts: int = _ATTEMPTS) -> Steps[RadioBoard]:
    """Find the bootloader, and identify the radio."""
    for attempt in range(1, attempts + 1):
        try:
            yield Request(_PADDING + bytes((SYNC, END)), "finding the bootloader of the radio", timeout=0.5)
        except BootloaderError:
            if attempt == attempts:
                raise
        else:
            break
    reply = yield Request(bytes((DEVICE, END)), "identifying the radio", fixed(2))
    return RadioBoard(*reply)


def flash(firmware: FirmwareFile, report: ReportProgress = no_progress) -> Steps[None]:
    """Erase, program and verify; the caller has checked the firmware."""
    report(Phase.ERASE, 0, 0)
    yield Request(bytes((ERASE, END)), "erasing the radio", timeout=_ERASE_TIMEOUT)
    total, done = firmware.size, 0
    for address, part in firmware.segments:
        yield _place(address)
        for block in _blocks(part, WRITE_SIZE):
            report(Phase.PROGRAM, done, total)
            yield Request(bytes((PROGRAM, len(block), *block, END)), "programming the radio")
            done += len(block)
    report(Phase.PROGRAM, total, total)
    yield from _verify(firmware, report)


def reboot() -> bytes:
    """Return the bytes that start the firmware; the radio does not answer them."""
    return bytes((REBOOT,))


def _verify(firmware: FirmwareFile, report: ReportProgress) -> Steps[None]:
    total, done = firmware.size, 0
    for address, part in firmware.segments:
        yield _place(address)
        for block in _blocks(part, READ_SIZE):
            report(Phase.VERIFY, done, total)
            data = bytes((READ, len(block), END))
            if (yield Request(data, "verifying the radio", fixed(len(block)))) != block:
                raise BootloaderError(
                    f"verifying the radio failed near address {address + done:#x}; flash it again"
                )
            done += len(block)


def _place(address: int) -> Request:
    return Request(bytes((ADDRESS, address & 0xFF, address >> 8, END)), "programming the radio")


def _blocks(data: bytes, size: int) -> Iterator[bytes]:
    return (data[start : start + size] for start in range(0, len(data), size))
