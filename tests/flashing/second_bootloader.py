"""A second bootloader, written from the description of the protocol and not from ours: a coroutine of bytes.

It knows nothing of `mavstack.flashing`; its flash is a dictionary of words, and its CRC goes bit by bit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Generator

IN_STEP, FINE, BROKEN, NONSENSE, END = 0x12, 0x10, 0x11, 0x13, 0x20
EMPTY = 0xFFFFFFFF


def crc_by_bits(data: bytes) -> int:
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0xEDB88320 if crc & 1 else 0)
    return crc


class NonsenseError(Exception):
    pass


class SecondBootloader:
    """A board of a given size in bytes; `words` is its flash."""

    def __init__(self, board_id: int = 9, size: int = 8192, revision: int = 4) -> None:
        self.board_id, self.size, self.revision = board_id, size, revision
        self.words: dict[int, int] = {}
        self.erased = 0
        self.running_firmware = False
        self.switch_on()

    def switch_on(self) -> None:
        self.sent = bytearray()
        self.first: int | None = None
        self.place = self.reading = 0
        self.known: set[int] = set()
        self.machine = self.loop()
        next(self.machine)

    def content(self) -> bytes:
        return b"".join(self.words.get(at, EMPTY).to_bytes(4, "little") for at in range(0, self.size, 4))

    def take(self, data: bytes) -> None:
        for byte in data:
            self.machine.send(byte)

    def silence(self) -> None:
        """A second without a byte: a request that has begun is nonsense."""
        self.machine.send(None)

    def loop(self) -> Generator[None, int | None, None]:
        while True:
            command = yield
            if command is None:
                continue
            try:
                answer = yield from self.command(command)
            except NonsenseError:
                self.sent += bytes((IN_STEP, NONSENSE))
            else:
                if answer is not None:
                    self.sent += answer + bytes((IN_STEP, FINE))

    def byte(self) -> Generator[None, int | None, int]:
        value = yield
        if value is None:
            raise NonsenseError
        return value

    def end(self) -> Generator[None, int | None, None]:
        if (yield from self.byte()) != END:
            raise NonsenseError

    def command(self, command: int) -> Generator[None, int | None, bytes | None]:
        if command == 0x21:
            yield from self.end()
            return b""
        if command == 0x22:
            which = yield from self.byte()
            yield from self.end()
            facts = {1: self.revision, 2: self.board_id, 3: 0, 4: self.size}
            if which not in facts:
                raise NonsenseError
            self.known.add(which)
            return facts[which].to_bytes(4, "little")
        if command == 0x23:
            yield from self.end()
            if self.known != {1, 2, 3, 4}:
                raise NonsenseError
            self.words, self.first, self.place = {}, None, 0
            self.erased += 1
            return b""
        if command == 0x27:
            return (yield from self.write())
        if command == 0x29 and self.revision >= 3:
            yield from self.end()
            first = EMPTY if self.first is None else self.first
            return crc_by_bits(first.to_bytes(4, "little") + self.content()[4:]).to_bytes(4, "little")
        if command in (0x24, 0x28) and self.revision == 2:
            return (yield from self.read_back(command))
        if command == 0x30:
            yield from self.end()
            self.store_first()
            self.running_firmware = self.words.get(0, EMPTY) != EMPTY
            return b""
        return None

    def read_back(self, command: int) -> Generator[None, int | None, bytes]:
        count = (yield from self.byte()) if command == 0x28 else 0
        yield from self.end()
        if command == 0x24:
            self.reading = 0
            self.store_first()
        self.reading += count
        return self.content()[self.reading - count : self.reading]

    def write(self) -> Generator[None, int | None, bytes]:
        count = yield from self.byte()
        if count % 4 or self.place + count > self.size:
            raise NonsenseError
        block = bytearray()
        for _ in range(count):
            block.append((yield from self.byte()))
        yield from self.end()
        for at in range(0, count, 4):
            word = int.from_bytes(block[at : at + 4], "little")
            if self.place + at == 0:
                self.first = word
            else:
                self.words[self.place + at] = word
        self.place += count
        return b""

    def store_first(self) -> None:
        if self.first is not None:
            self.words[0] = self.first
            self.first = None
