"""The ROM of an STM32F405 on a serial port, sans-IO, for programs such as stm32flash.

The ROM is the bootloader that Betaflight and iNav start for new firmware. Source: ST's application notes
AN3155 (protocol on a UART) and AN2606 (the memory of each chip). A write turns bits of the flash from one to
zero only, so that a program which does not erase before is found.
"""

from __future__ import annotations

from collections.abc import Generator
from functools import reduce
from operator import xor
from typing import TYPE_CHECKING, Final, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable

ACK, NACK, SYNC = 0x79, 0x1F, 0x7F
FLASH_START: Final = 0x0800_0000
FLASH_SIZE: Final = 1 << 20
RAM_START: Final = 0x2000_0000
RAM_SIZE: Final = 128 << 10
CHIP_ID: Final = 0x413
VERSION: Final = 0x31
GET, GET_VERSION, GET_ID, READ, GO, WRITE, ERASE = 0x00, 0x01, 0x02, 0x11, 0x21, 0x31, 0x44
_COMMANDS: Final = (GET, GET_VERSION, GET_ID, READ, GO, WRITE, ERASE)
#: The sizes of the flash sectors in bytes.
SECTORS: Final = (16 << 10,) * 4 + (64 << 10,) + (128 << 10,) * 7
_MASS_ERASE: Final = 0xFFFF
#: Address ranges that upload programs read, filled with ones in this simulation: ROM, and option bytes.
_READABLE: Final = (range(0x1FFF_0000, 0x1FFF_7A10), range(0x1FFF_C000, 0x1FFF_C010))

#: Yields the number of bytes that it needs next, and receives them.
_Steps: TypeAlias = Generator[int, bytes, None]


class SimulatedRom:
    """A chip that waits in its ROM for a program."""

    def __init__(self) -> None:
        self.flash = bytearray(b"\xff" * FLASH_SIZE)
        self.ram = bytearray(RAM_SIZE)
        #: The address at which a program was started; None while the ROM runs.
        self.started: int | None = None
        #: Called with each event, such as `flash erased`.
        self.on_event: Callable[[str], None] = lambda text: None
        self.power_cycle()

    def power_cycle(self) -> None:
        """Start the ROM again; the flash stays, the RAM does not."""
        self.started = None
        self.ram = bytearray(RAM_SIZE)
        self._input, self._output = bytearray(), bytearray()
        self._steps = self._serve()
        self._needed = next(self._steps)

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes of a host."""
        self._input += data
        while self.started is None and len(self._input) >= self._needed:
            taken = bytes(self._input[: self._needed])
            del self._input[: self._needed]
            self._needed = self._steps.send(taken)

    def output(self) -> bytes:
        """Return the bytes for the host, once."""
        data = bytes(self._output)
        self._output.clear()
        return data

    def next_timeout(self) -> None:
        """Return None: the ROM waits without end."""

    def handle_timeout(self, now: float) -> None:
        """Do nothing: the ROM has no timers."""

    def _serve(self) -> _Steps:
        """Run the ROM: the byte from which it learns the baud rate, then commands without end."""
        while (yield 1)[0] != SYNC:
            pass
        self._answer(ACK)
        while True:
            command = (yield 1)[0]
            if command == SYNC:  # an upload program connects again
                self._answer(NACK)
                continue
            if (yield 1)[0] != command ^ 0xFF or command not in _COMMANDS:
                self._answer(NACK)
                continue
            self._answer(ACK)
            yield from self._run(command)

    def _run(self, command: int) -> _Steps:
        if command == GET:
            self._answer(len(_COMMANDS), VERSION, *_COMMANDS, ACK)
        elif command == GET_VERSION:
            self._answer(VERSION, 0, 0, ACK)
        elif command == GET_ID:
            self._answer(1, CHIP_ID >> 8, CHIP_ID & 0xFF, ACK)
        elif command == ERASE:
            yield from self._erase()
        else:
            address = yield from self._address()
            if address is not None:
                yield from {READ: self._read, WRITE: self._write, GO: self._go}[command](address)

    def _address(self) -> Generator[int, bytes, int | None]:
        """Take an address with its checksum."""
        data = yield 5
        if reduce(xor, data):
            self._answer(NACK)
            return None
        return int.from_bytes(data[:4], "big")

    def _read(self, address: int) -> _Steps:
        if self._memory(address, 1) is None:
            self._answer(NACK)
            return
        self._answer(ACK)
        count, check = yield 2
        data = self._memory(address, count + 1)
        if count ^ check != 0xFF or data is None:
            self._answer(NACK)
            return
        self._answer(ACK, *data)

    def _write(self, address: int) -> _Steps:
        if self._memory(address, 1) is None:
            self._answer(NACK)
            return
        self._answer(ACK)
        count = (yield 1)[0]
        data = yield count + 2
        place = self._writable(address, count + 1)
        if reduce(xor, data, count) or place is None or address % 4:
            self._answer(NACK)
            return
        memory, start = place
        for index, value in enumerate(data[:-1], start):
            memory[index] = value if memory is self.ram else memory[index] & value
        self._answer(ACK)

    def _go(self, address: int) -> _Steps:
        yield 0
        if self._memory(address, 4) is None:
            self._answer(NACK)
            return
        self._answer(ACK)
        self.started = address
        self.on_event(f"program started at {address:#010x}")

    def _erase(self) -> _Steps:
        """Erase sectors, or the whole flash (the extended form)."""
        head = yield 2
        count = int.from_bytes(head, "big")
        if count == _MASS_ERASE:
            rest = yield 1
            sectors = list(range(len(SECTORS)))
        else:
            rest = yield 2 * (count + 1) + 1
            sectors = [int.from_bytes(rest[at : at + 2], "big") for at in range(0, len(rest) - 1, 2)]
        if reduce(xor, head + rest) or max(sectors) >= len(SECTORS):
            self._answer(NACK)
            return
        for sector in sectors:
            start = sum(SECTORS[:sector])
            self.flash[start : start + SECTORS[sector]] = b"\xff" * SECTORS[sector]
        self._answer(ACK)
        self.on_event("flash erased" if len(sectors) == len(SECTORS) else f"{len(sectors)} sectors erased")

    def _writable(self, address: int, count: int) -> tuple[bytearray, int] | None:
        """Return the memory of an address, and the place in it; None if it cannot be written."""
        for memory, start in ((self.flash, FLASH_START), (self.ram, RAM_START)):
            if start <= address and address + count <= start + len(memory):
                return memory, address - start
        return None

    def _memory(self, address: int, count: int) -> bytes | None:
        """Return bytes at an address; None if there is no memory."""
        place = self._writable(address, count)
        if place is not None:
            memory, start = place
            return bytes(memory[start : start + count])
        if any(address in part and address + count - 1 in part for part in _READABLE):
            return b"\xff" * count
        return None

    def _answer(self, *values: int) -> None:
        self._output += bytes(values)
