"""Logs in memory, for the servers of these tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.log import LogEntry

if TYPE_CHECKING:
    from random import Random


class MemoryStore:
    def __init__(self, contents: dict[int, bytes], times: dict[int, int] | None = None) -> None:
        self.contents = contents
        self.times = times or {}
        self.broken = False

    def logs(self) -> list[LogEntry]:
        return [
            LogEntry(number, self.times.get(number, 1_600_000_000 + number), len(content))
            for number, content in sorted(self.contents.items())
        ]

    def read(self, number: int, offset: int, count: int) -> bytes:
        if self.broken:
            raise OSError("the card is gone")
        return self.contents.get(number, b"")[offset : offset + count]

    def erase(self) -> None:
        if self.broken:
            raise OSError("the card is gone")
        self.contents.clear()


def random_store(random: Random, first: int | None = None) -> MemoryStore:
    first = random.choice([0, 1]) if first is None else first
    sizes = [
        random.choice([0, 1, 89, 90, 91, 900, random.randrange(40_000)]) for _ in range(random.randrange(6))
    ]
    return MemoryStore({first + index: random.randbytes(size) for index, size in enumerate(sizes)})
