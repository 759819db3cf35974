"""A simulated bootloader of PX4 or ArduPilot, sans-IO: any uploader can flash it.

As the real ones it erases only after it was asked what it is, keeps the first words of a firmware until
REBOOT, answers a request without its end by INVALID after a second, and ignores bytes that are no request.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.flashing.board import Board
from mavstack.flashing.bootloader_client import EOC, Device, Op, flash_crc
from mavstack.flashing.conversation import FAILED, INSYNC, INVALID, OK

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

PX4_BOARD: Final = Board(
    bootloader=5,
    board_id=50,
    board_revision=0,
    flash_size=2_064_384,
    chip=0x2001_0451,
    chip_name="STM32F7[6|7]x,Z",
    serial="002b00443137511134383530",
    version="Mavstack 1",
)
ARDUPILOT_BOARD: Final = Board(
    bootloader=5,
    board_id=140,
    board_revision=0,
    flash_size=1_966_080,
    external_size=8_388_608,
    chip=0x2003_0450,
    chip_name="STM32H7[4|5]x,V",
)
#: Seconds to wait for the rest of a request.
REQUEST_TIMEOUT: Final = 1.0
#: Number of bytes at the beginning of the firmware that are written only at REBOOT.
_FIRST_WORDS: Final = 32
#: Values of GET_DEVICE that must have been requested before the flash is erased.
_IDENTIFIED: Final = frozenset({1, 2, 3, 4})
_SECTOR: Final = 65536
#: Size of the arguments of each request without EOC, in bytes; None: a count, and then as many bytes.
_ARGUMENTS: Final[Mapping[int, int | None]] = MappingProxyType(
    {
        Op.GET_SYNC: 0,
        Op.GET_DEVICE: 1,
        Op.CHIP_ERASE: 0,
        Op.CHIP_FULL_ERASE: 0,
        Op.CHIP_VERIFY: 0,
        Op.PROG_MULTI: None,
        Op.READ_MULTI: 1,
        Op.GET_CRC: 0,
        Op.GET_OTP: 4,
        Op.GET_SN: 4,
        Op.GET_CHIP: 0,
        Op.SET_BOOT_DELAY: 1,
        Op.GET_CHIP_DES: 0,
        Op.GET_VERSION: 0,
        Op.REBOOT: 0,
        Op.EXTF_ERASE: 4,
        Op.EXTF_PROG_MULTI: None,
        Op.EXTF_READ_MULTI: 1,
        Op.EXTF_GET_CRC: 4,
        Op.VERIFY_SIG: 0,
    }
)
#: The minimum protocol revision of each request.
_SINCE: Final[Mapping[int, int]] = MappingProxyType(
    {
        Op.GET_CRC: 3,
        Op.GET_OTP: 4,
        Op.GET_SN: 4,
        Op.GET_CHIP: 5,
        Op.GET_CHIP_DES: 5,
        Op.SET_BOOT_DELAY: 5,
        Op.GET_VERSION: 5,
        Op.CHIP_FULL_ERASE: 6,
    }
)


class RefusedError(Exception):
    """The bootloader answers with a status that is not OK."""

    def __init__(self, status: int = INVALID) -> None:
        self.status = status
        super().__init__(status)


@dataclass
class Flash:
    """A flash memory.

    Attributes:
        content: Its bytes.
        address: The place of the next block to write.
        read_address: The place of the next block to read.
        broken: True if programming does not change it.
    """

    content: bytearray
    address: int = 0
    read_address: int = 0
    broken: bool = False

    def erase(self) -> None:
        """Set all bits."""
        self.content[:] = b"\xff" * len(self.content)
        self.address = self.read_address = 0

    def program(self, block: bytes) -> None:
        """Write the next block; raises RefusedError behind the end."""
        end = self.address + len(block)
        if end > len(self.content):
            raise RefusedError
        if not self.broken:
            self.content[self.address : end] = block
        self.address = end

    def read(self, size: int) -> bytes:
        """Read the next block."""
        block = bytes(self.content[self.read_address : self.read_address + size])
        self.read_address += size
        return block


class SimulatedBootloader:
    """A bootloader and its flash.

    Args:
        board: The board.
        verify: Tells whether an image has a valid signature; None: a bootloader without secure boot.
    """

    def __init__(self, board: Board = PX4_BOARD, verify: Callable[[bytes], bool] | None = None) -> None:
        self.board = board
        self.internal = Flash(bytearray(b"\xff" * board.flash_size))
        self.external = Flash(bytearray(b"\xff" * board.external_size))
        #: Called with each request after its execution.
        self.listeners: list[Callable[[Op], None]] = []
        self._verify = verify
        self._handlers = self._made_handlers()
        self.power_cycle()

    def _made_handlers(self) -> dict[int, Callable[[bytes], bytes]]:
        """Return the handlers of the requests."""
        known: dict[int, Callable[[bytes], bytes]] = {
            Op.GET_SYNC: self._sync,
            Op.GET_DEVICE: self._device,
            Op.CHIP_ERASE: self._erase,
            Op.CHIP_FULL_ERASE: self._erase,
            Op.PROG_MULTI: self._program,
            Op.GET_CRC: lambda _: _word(flash_crc(self._present(), len(self.internal.content))),
            Op.GET_OTP: lambda _: b"\xff" * 4,
            Op.GET_SN: self._serial,
            Op.GET_CHIP: lambda _: _word(self.board.chip or 0),
            Op.GET_CHIP_DES: lambda _: _counted(self.board.chip_name),
            Op.GET_VERSION: lambda _: _counted(self.board.version),
            Op.SET_BOOT_DELAY: lambda _: b"",
            Op.REBOOT: self._reboot,
            Op.EXTF_ERASE: self._erase_external,
            Op.EXTF_PROG_MULTI: self._program_external,
            Op.EXTF_READ_MULTI: lambda size: self.external.read(size[0]),
            Op.EXTF_GET_CRC: self._external_crc,
            Op.VERIFY_SIG: self._verify_signature,
            Op.CHIP_VERIFY: self._begin_reading,
            Op.READ_MULTI: self._read,
        }
        revision = self.board.bootloader
        return {op: handler for op, handler in known.items() if _SINCE.get(op, 0) <= revision}

    @property
    def has_firmware(self) -> bool:
        """True if there is a firmware that can start: its first words are written last."""
        return self.internal.content[:4] != b"\xff" * 4

    def power_cycle(self) -> None:
        """Lose the power for a moment: only the flash keeps its content."""
        self._input = bytearray()
        self._output = bytearray()
        self._deadline: float | None = None
        self._synced = False
        self._identified: frozenset[int] = frozenset()
        self._first_words = b""
        self.internal.address = self.internal.read_address = 0
        self.external.address = self.external.read_address = 0
        #: True once the firmware was started.
        self.started = False

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes of an uploader."""
        self.handle_timeout(now)
        self._input += data
        while self._input and not self.started:
            size = self._request_size()
            if size is None:
                self._deadline = now + REQUEST_TIMEOUT
                return
            request = bytes(self._input[:size])
            del self._input[:size]
            self._deadline = None
            self._run(request)

    def output(self) -> bytes:
        """Return the bytes for the uploader, once."""
        data = bytes(self._output)
        self._output.clear()
        return data

    def next_timeout(self) -> float | None:
        """Return the time of the next `handle_timeout`, or None."""
        return self._deadline

    def handle_timeout(self, now: float) -> None:
        """Give up a request whose rest does not come."""
        if self._deadline is not None and now >= self._deadline:
            self._input.clear()
            self._deadline = None
            self._answer(INVALID)

    def _request_size(self) -> int | None:
        """Return the bytes of the first request; 1 for a byte that is none, None while bytes are missing."""
        op = self._input[0]
        if op not in self._handlers:
            return 1
        size = _ARGUMENTS[op]
        if size is None:
            size = 1 + self._input[1] if len(self._input) > 1 else None
        whole = None if size is None else size + 2
        return whole if whole is not None and len(self._input) >= whole else None

    def _run(self, request: bytes) -> None:
        handler = self._handlers.get(request[0])
        if handler is None:
            return
        if request[-1] != EOC:
            self._answer(INVALID)
            return
        try:
            reply = handler(request[1:-1])
        except RefusedError as refused:
            self._answer(refused.status)
        else:
            self._output += reply
            self._answer(OK)
            for listener in self.listeners:
                listener(Op(request[0]))

    def _answer(self, status: int) -> None:
        self._output += bytes((INSYNC, status))

    # Requests

    def _sync(self, _: bytes) -> bytes:
        self._synced = True
        return b""

    def _device(self, which: bytes) -> bytes:
        board = self.board
        values = {
            Device.PROTOCOL_REVISION: board.bootloader,
            Device.BOARD_ID: board.board_id,
            Device.BOARD_REVISION: board.board_revision,
            Device.FLASH_SIZE: board.flash_size,
        }
        if board.external_size:
            values[Device.EXTERNAL_SIZE] = board.external_size
        self.internal.read_address = 0
        if which[0] == Device.VECTORS:
            return bytes(self.internal.content[28:44])
        if which[0] not in values:
            raise RefusedError
        self._identified |= {which[0]}
        return _word(values[Device(which[0])])

    def _check_identified(self) -> None:
        if not self._synced or not self._identified >= _IDENTIFIED:
            raise RefusedError

    def _erase(self, _: bytes) -> bytes:
        self._check_identified()
        self.internal.erase()
        self._first_words = b""
        return b""

    def _program(self, data: bytes) -> bytes:
        self._check_identified()
        block = data[1:]
        if len(block) % 4:
            raise RefusedError
        at = self.internal.address
        if at < _FIRST_WORDS:
            kept = block[: _FIRST_WORDS - at]
            self._first_words = self._first_words[:at] + kept
            block = b"\xff" * len(kept) + block[len(kept) :]
        self.internal.program(block)
        return b""

    def _present(self) -> bytes:
        """Return the flash with the first words that are not written yet."""
        return self._first_words + bytes(self.internal.content[len(self._first_words) :])

    def _begin_reading(self, _: bytes) -> bytes:
        """Answer CHIP_VERIFY of revision 2: write the first words now, and read from the beginning."""
        if self.board.bootloader > 2:
            raise RefusedError
        self._write_first_words()
        self.internal.read_address = 0
        return b""

    def _read(self, size: bytes) -> bytes:
        return self.internal.read(size[0])

    def _write_first_words(self) -> None:
        if not self.internal.broken:
            self.internal.content[: len(self._first_words)] = self._first_words
        self._first_words = b""

    def _serial(self, place: bytes) -> bytes:
        start = 2 * int.from_bytes(place, "little")
        return bytes.fromhex(self.board.serial.ljust(24, "0")[start : start + 8])[::-1].ljust(4, b"\0")

    def _reboot(self, _: bytes) -> bytes:
        if self._first_words:
            self._write_first_words()
        if self.internal.broken:
            raise RefusedError(FAILED)
        self.started = self.has_firmware
        return b""

    def _erase_external(self, size: bytes) -> bytes:
        self._check_identified()
        total = int.from_bytes(size, "little")
        if not self.external.content or total > len(self.external.content):
            raise RefusedError
        self.external.erase()
        percentages = bytes(min(100, 100 * done // total) for done in range(0, total, _SECTOR))
        return bytes((INSYNC, OK, 0)) + percentages + bytes((100,))

    def _program_external(self, data: bytes) -> bytes:
        self._check_identified()
        self.external.program(data[1:])
        return b""

    def _external_crc(self, size: bytes) -> bytes:
        total = int.from_bytes(size, "little")
        return _word(flash_crc(bytes(self.external.content[:total]), total))

    def _verify_signature(self, _: bytes) -> bytes:
        if self._verify is None:
            raise RefusedError
        if not self._verify(self._present()):
            raise RefusedError(FAILED)
        return b""


def board_of(firmware: str, board_id: int | None = None) -> Board:
    """Return the simulated board of a firmware, "px4" or "ardupilot"."""
    board = PX4_BOARD if firmware == "px4" else ARDUPILOT_BOARD
    return board if board_id is None else replace(board, board_id=board_id)


def _word(value: int) -> bytes:
    return value.to_bytes(4, "little")


def _counted(text: str) -> bytes:
    data = text.encode("ascii")
    return _word(len(data)) + data
