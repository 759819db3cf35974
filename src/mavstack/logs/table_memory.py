"""The memory of tables that are decoded together.

The kernel clears each new page of 4 KiB on its own, which takes as long as the decoding. Blocks of at least
4 MiB have pages of 2 MiB, and are used again when their tables are dropped. Small tables share such blocks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.reused_memory import ReusedMemory

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

#: Minimum size in bytes of a table that gets a separate memory block with large pages.
_LARGE: Final = 4 << 20
#: Maximum size of a block in bytes.
_MAX_BLOCK: Final = 32 << 20
#: Tables begin at a multiple of the size of a cache line.
_ALIGNMENT: Final = 64
_REUSED: Final = ReusedMemory()


def new_tables(kinds: Sequence[tuple[np.dtype[np.void], int]]) -> list[NDArray[np.void]]:
    """Return tables whose rows are to be written.

    Args:
        kinds: Type and number of rows of each table.

    Returns:
        The tables, in this order.
    """
    sizes = [dtype.itemsize * rows for dtype, rows in kinds]
    tables: dict[int, NDArray[np.void]] = {}
    for numbers in _blocks(sizes):
        block = _memory(sum(_padded(sizes[number]) for number in numbers))
        start = 0
        for number in numbers:
            tables[number] = block[start : start + sizes[number]].view(kinds[number][0])
            start += _padded(sizes[number])
    return [
        tables[number] if number in tables else _memory(sizes[number]).view(dtype)
        for number, (dtype, _) in enumerate(kinds)
    ]


def _memory(size: int) -> NDArray[np.uint8]:
    return _REUSED.take(size) if size >= _LARGE else np.empty(size, np.uint8)


def _blocks(sizes: Sequence[int]) -> Iterator[list[int]]:
    """Yield the numbers of the tables that share a block."""
    block: list[int] = []
    total = 0
    for number, size in enumerate(sizes):
        if not 0 < size < _LARGE:
            continue
        if total + _padded(size) > _MAX_BLOCK:
            yield block
            block, total = [], 0
        block.append(number)
        total += _padded(size)
    if len(block) > 1:
        yield block


def _padded(size: int) -> int:
    return (size + _ALIGNMENT - 1) // _ALIGNMENT * _ALIGNMENT
