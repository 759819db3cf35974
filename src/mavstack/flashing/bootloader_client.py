"""The bootloader of PX4 and ArduPilot, seen by a program: identify, erase, program, verify, reboot.

Sources: `bl.c` of PX4, `bl_protocol.cpp` of ArduPilot and their uploaders. The bootloader keeps the first
words of a firmware until REBOOT, so that a board that loses its power before stays in the bootloader.
"""

from __future__ import annotations

import zlib
from enum import IntEnum
from typing import TYPE_CHECKING, Final, TypeVar

from mavstack.flashing.board import CHIP_REVISION, Board, check_firmware
from mavstack.flashing.conversation import (
    INSYNC,
    INVALID,
    OK,
    Request,
    Steps,
    counted,
    fixed,
    refusable,
)
from mavstack.flashing.failures import BootloaderError
from mavstack.flashing.firmware_file import FirmwareKind
from mavstack.flashing.progress import Phase, ReportProgress, no_progress

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.flashing.firmware_file import FirmwareFile

T = TypeVar("T")

EOC: Final = 0x20
#: Size of a block in bytes: a multiple of four below 256.
BLOCK_SIZE: Final = 252
#: Timeouts of the attempts to find the bootloader: it drops an incomplete request after one second.
SYNC_TIMEOUTS: Final = (0.3, 0.5, 1.3, 1.3, 1.3)
SYNC_ATTEMPTS: Final = len(SYNC_TIMEOUTS)
#: Seconds to wait for a detail of the board which old bootloaders do not report.
DETAIL_TIMEOUT: Final = 0.3
ERASE_TIMEOUT: Final = 40.0
#: Seconds to wait for the answer to REBOOT, which bootloaders of revision 2 do not send.
REBOOT_TIMEOUT: Final = 1.0
#: Seconds to wait for the CRC of the whole flash.
CRC_TIMEOUT: Final = 10.0
#: Seconds to wait for the verification of a signature.
SIGNATURE_TIMEOUT: Final = 5.0
#: Seconds to wait for the next percentage while the external flash is erased, and for its CRC.
EXTERNAL_TIMEOUT: Final = 120.0
_WORD: Final = fixed(4)
_SERIAL_WORDS: Final = (0, 4, 8)
#: Number of blocks between two progress reports.
_REPORT_BLOCKS: Final = 32


class Op(IntEnum):
    """The requests of the protocol."""

    GET_SYNC = 0x21
    GET_DEVICE = 0x22
    CHIP_ERASE = 0x23
    CHIP_VERIFY = 0x24
    PROG_MULTI = 0x27
    READ_MULTI = 0x28
    GET_CRC = 0x29
    GET_OTP = 0x2A
    GET_SN = 0x2B
    GET_CHIP = 0x2C
    SET_BOOT_DELAY = 0x2D
    GET_CHIP_DES = 0x2E
    GET_VERSION = 0x2F
    REBOOT = 0x30
    EXTF_ERASE = 0x34
    EXTF_PROG_MULTI = 0x35
    EXTF_READ_MULTI = 0x36
    EXTF_GET_CRC = 0x37
    VERIFY_SIG = 0x39
    CHIP_FULL_ERASE = 0x40


class Device(IntEnum):
    """The values that GET_DEVICE returns."""

    PROTOCOL_REVISION = 1
    BOARD_ID = 2
    BOARD_REVISION = 3
    FLASH_SIZE = 4
    VECTORS = 5
    EXTERNAL_SIZE = 6


def flash_crc(image: bytes, size: int) -> int:
    """Return the CRC of a flash with an image: CRC-32 that begins with 0 and is not inverted at the end."""
    crc = zlib.crc32(image, 0xFFFFFFFF)
    step = b"\xff" * 65536
    for start in range(len(image), size, len(step)):
        crc = zlib.crc32(step[: size - start], crc)
    return crc ^ 0xFFFFFFFF


def sync(attempts: int = SYNC_ATTEMPTS) -> Steps[None]:
    """Find the bootloader, whatever it was doing."""
    for attempt, seconds in enumerate(SYNC_TIMEOUTS[:attempts], 1):
        try:
            yield Request(_request(Op.GET_SYNC), "finding the bootloader", timeout=seconds)
        except BootloaderError:
            if attempt == attempts:
                raise
        else:
            return


def identify(attempts: int = SYNC_ATTEMPTS) -> Steps[Board]:
    """Find the bootloader, and identify the board."""
    yield from sync(attempts)
    revision = yield from _device(Device.PROTOCOL_REVISION)
    chip = chip_name = serial = None
    external = yield from _detail(_external_size())
    if revision >= CHIP_REVISION:
        chip = yield from _detail(_number(Op.GET_CHIP, timeout=DETAIL_TIMEOUT))
        chip_name = yield from _detail(_text(Op.GET_CHIP_DES))
    if revision >= CHIP_REVISION - 1:
        serial = yield from _detail(_serial())
    # Request these four last: a bootloader erases only if all of them were requested since it started.
    revision = yield from _device(Device.PROTOCOL_REVISION)
    board_id = yield from _device(Device.BOARD_ID)
    board_revision = yield from _device(Device.BOARD_REVISION)
    size = yield from _device(Device.FLASH_SIZE)
    return Board(
        bootloader=revision,
        board_id=board_id,
        board_revision=board_revision,
        flash_size=size,
        external_size=external or 0,
        chip=chip,
        chip_name=chip_name or "",
        serial=serial or "",
    )


def bootloader_version() -> Steps[str]:
    """Read the version of the bootloader; old ones do not answer, and the text is empty."""
    return (yield from _detail(_text(Op.GET_VERSION))) or ""


def flash(firmware: FirmwareFile, board: Board, report: ReportProgress = no_progress) -> Steps[None]:
    """Erase, program and verify; the firmware is checked first.

    Args:
        firmware: The firmware.
        board: The board, as `identify` found it.
        report: Called with the phase and the bytes done and in total.
    """
    check_firmware(firmware, board)
    if firmware.external:
        yield from _flash_external(firmware.external, report)
    report(Phase.ERASE, 0, 0)
    erase = Request(_request(Op.CHIP_ERASE), "erasing", timeout=ERASE_TIMEOUT)
    yield from _unless_restarted(_one(erase), "erasing")
    yield from _program(Op.PROG_MULTI, firmware.image, lambda done, total: report(Phase.PROGRAM, done, total))
    report(Phase.VERIFY, 0, 0)
    yield from _verify(firmware, board)


def reboot() -> Steps[None]:
    """Start the firmware, and make sure that the bootloader is gone.

    A board that loses its power before it has kept the first words of the firmware is in its bootloader
    again; then the firmware must be written once more.
    """
    try:
        yield Request(_request(Op.REBOOT), "starting the firmware", timeout=REBOOT_TIMEOUT)
    except BootloaderError as error:
        if error.status is not None and error.status > 0:
            raise
        yield from _check_gone()


def _check_gone() -> Steps[None]:
    try:
        yield from sync(1)
    except BootloaderError:
        return
    raise BootloaderError("starting the firmware failed: the board is in its bootloader again")


def _verify(firmware: FirmwareFile, board: Board) -> Steps[None]:
    if board.bootloader == 2:
        yield from _verify_by_reading(firmware.image)
    else:
        found = yield from _number(Op.GET_CRC, operation="verifying", timeout=CRC_TIMEOUT)
        _compare(found, flash_crc(firmware.image, board.flash_size))
    # Only for PX4: ArduPilot's bootloaders verify the signature by themselves before they start a firmware.
    if firmware.signed and firmware.kind is FirmwareKind.PX4:
        yield from _verify_signature()


def _verify_by_reading(image: bytes) -> Steps[None]:
    yield Request(_request(Op.CHIP_VERIFY), "verifying")
    for start in range(0, len(image), BLOCK_SIZE):
        block = image[start : start + BLOCK_SIZE]
        data = _request(Op.READ_MULTI, bytes([len(block)]))
        if (yield Request(data, "verifying", fixed(len(block)))) != block:
            raise BootloaderError(f"verifying failed: the flash differs at byte {start}; flash it again")


def _verify_signature() -> Steps[None]:
    """Let the bootloader verify the signature; one without secure boot cannot, and takes no signed image."""
    try:
        yield Request(_request(Op.VERIFY_SIG), "verifying the signature", timeout=SIGNATURE_TIMEOUT)
    except BootloaderError as error:
        if error.status == INVALID or error.status is None:
            text = "verifying the signature failed: the bootloader has no secure boot; flash one without"
            raise BootloaderError(text, error.status) from None
        raise


def _flash_external(image: bytes, report: ReportProgress) -> Steps[None]:
    size = len(image).to_bytes(4, "little")
    report(Phase.ERASE_EXTERNAL, 0, 0)
    data = _request(Op.EXTF_ERASE, size)
    erase = Request(data, "erasing the external flash", _external_erased, EXTERNAL_TIMEOUT)
    yield from _unless_restarted(_one(erase), erase.operation)
    yield from _program(
        Op.EXTF_PROG_MULTI, image, lambda done, total: report(Phase.PROGRAM_EXTERNAL, done, total)
    )
    found = yield from _number(
        Op.EXTF_GET_CRC, size, "verifying the external flash", timeout=EXTERNAL_TIMEOUT
    )
    _compare(found, flash_crc(image, len(image)))


def _unless_restarted(steps: Steps[T], operation: str) -> Steps[T]:
    """Explain a request that a bootloader does not accept, since it was restarted after it was identified."""
    try:
        return (yield from steps)
    except BootloaderError as error:
        if error.status == INVALID:
            raise BootloaderError(f"{operation} failed: the board restarted meanwhile") from None
        raise


def _one(request: Request) -> Steps[None]:
    yield request


def _external_erased(data: bytes) -> int | None:
    """Find the end of erasing: a status, percentages up to 100, and a status."""
    if len(data) >= 2 and data[1] != OK:
        return 2
    return len(data) if data[-3:] == bytes((100, INSYNC, OK)) else None


def _program(op: Op, image: bytes, report: Callable[[int, int], None]) -> Steps[None]:
    yield from _unless_restarted(_blocks(op, image, report), "programming")


def _blocks(op: Op, image: bytes, report: Callable[[int, int], None]) -> Steps[None]:
    total = len(image)
    for number, start in enumerate(range(0, total, BLOCK_SIZE)):
        block = image[start : start + BLOCK_SIZE]
        if number % _REPORT_BLOCKS == 0:
            report(start, total)
        yield Request(b"%c%c%b%c" % (op, len(block), block, EOC), "programming")
    report(total, total)


def _compare(found: int, expected: int) -> None:
    if found != expected:
        raise BootloaderError(
            f"verifying failed: the CRC of the flash is {found:#010x}, not {expected:#010x}; flash it again"
        )


def _number(
    op: Op, argument: bytes = b"", operation: str = "identifying the board", timeout: float = 2.0
) -> Steps[int]:
    reply = yield Request(_request(op, argument), operation, _WORD, timeout)
    return int.from_bytes(reply, "little")


def _device(which: Device) -> Steps[int]:
    return (yield from _number(Op.GET_DEVICE, bytes([which])))


def _external_size() -> Steps[int]:
    data = _request(Op.GET_DEVICE, bytes([Device.EXTERNAL_SIZE]))
    reply = yield Request(data, "identifying the board", refusable(4), DETAIL_TIMEOUT)
    return int.from_bytes(reply, "little")


def _text(op: Op) -> Steps[str]:
    reply = yield Request(_request(op), "identifying the board", counted, DETAIL_TIMEOUT)
    return reply[4:].rstrip(b"\0").decode("ascii", "replace")


def _serial() -> Steps[str]:
    words = []
    for place in _SERIAL_WORDS:
        value = yield from _number(Op.GET_SN, place.to_bytes(4, "little"), timeout=DETAIL_TIMEOUT)
        words.append(f"{value:08x}")
    return "".join(words)


def _detail(steps: Steps[T]) -> Steps[T | None]:
    """Read a value that old bootloaders do not know; None then."""
    try:
        return (yield from steps)
    except BootloaderError:
        yield from sync()
        return None


def _request(op: Op, argument: bytes = b"") -> bytes:
    return bytes([op]) + argument + bytes([EOC])
