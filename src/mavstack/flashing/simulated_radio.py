"""A simulated SiK radio with its bootloader, sans-IO: the near radio of a pair, on one serial port."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.flashing.conversation import INSYNC, OK
from mavstack.flashing.sik_client import (
    ADDRESS,
    DEVICE,
    END,
    ERASE,
    PROGRAM,
    READ,
    REBOOT,
    SYNC,
)
from mavstack.radio import RadioPair

if TYPE_CHECKING:
    from collections.abc import Callable

FLASH_SIZE: Final = 0xF800
#: Size in bytes of each request with a fixed size.
_SIZES: Final = {SYNC: 2, DEVICE: 2, ERASE: 2, ADDRESS: 4, READ: 3, REBOOT: 1}


class SimulatedSikRadio:
    """A radio that starts its bootloader by AT&UPDATE.

    Args:
        board: The number of its board.
        frequency: The code of its band.
        has_firmware: False: begin in the bootloader.
    """

    def __init__(self, board: int = 0x4E, frequency: int = 0x91, *, has_firmware: bool = True) -> None:
        self.pair = RadioPair()
        self.board, self.frequency = board, frequency
        self.flash = bytearray(b"\xff" * FLASH_SIZE)
        self.in_bootloader = not has_firmware
        #: Called when the flash is erased.
        self.on_erase: Callable[[], None] = lambda: None
        self._input, self._output = bytearray(), bytearray()
        self._address = 0

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes of a host."""
        if not self.in_bootloader:
            self.pair.receive(0, data, now)
            self._look_for_update()
            return
        self._input += data
        while self._input and self.in_bootloader:
            size = self._size()
            if size is None:
                return
            request = bytes(self._input[:size])
            del self._input[:size]
            self._run(request, now)

    def output(self) -> bytes:
        """Return the bytes for the host, once."""
        data = bytes(self._output) + (b"" if self.in_bootloader else self.pair.output(0))
        self._output.clear()
        return data

    def next_timeout(self) -> float | None:
        """Return the time of the next `handle_timeout`, or None."""
        return None if self.in_bootloader else self.pair.next_timeout()

    def handle_timeout(self, now: float) -> None:
        """Advance to the time `now`."""
        if not self.in_bootloader:
            self.pair.advance(now)
            self._look_for_update()

    def _look_for_update(self) -> None:
        if self.pair.near.updating:
            self.pair.near.updating, self.in_bootloader = False, True
            self._input.clear()

    def _size(self) -> int | None:
        """Return the bytes of the first request; 1 for a byte that is none, None while bytes are missing."""
        kind = self._input[0]
        if kind == PROGRAM:
            size = None if len(self._input) < 2 else self._input[1] + 3
        else:
            size = _SIZES.get(kind, 1)
        return size if size is not None and len(self._input) >= size else None

    def _run(self, request: bytes, now: float) -> None:
        kind = request[0]
        if kind == REBOOT:
            self.in_bootloader = False
            self.pair.near.reboot(now)
        elif (kind in _SIZES or kind == PROGRAM) and request[-1] == END:
            self._output += self._answer(kind, request) + bytes((INSYNC, OK))

    def _answer(self, kind: int, request: bytes) -> bytes:
        if kind == DEVICE:
            return bytes((self.board, self.frequency))
        if kind == ERASE:
            self.flash[:] = b"\xff" * FLASH_SIZE
            self.on_erase()
        elif kind == ADDRESS:
            self._address = request[1] | request[2] << 8
        elif kind == PROGRAM:
            block = request[2:-1]
            self.flash[self._address : self._address + len(block)] = block
            self._address += len(block)
        elif kind == READ:
            start, self._address = self._address, self._address + request[1]
            return bytes(self.flash[start : self._address])
        return b""
