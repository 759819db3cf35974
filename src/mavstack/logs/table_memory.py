"""The memory of tables that are decoded together.

The kernel clears each new page of 4 KiB on its own, which takes as long as the decoding. numpy asks for pages
of 2 MiB from 4 MiB on. Small tables share such blocks, whose memory is returned when the last of them is
dropped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

#: Size in bytes from which numpy asks for large pages: such a table has its own memory.
_LARGE: Final = 4 << 20
#: Maximum size of a block in bytes.
_MAX_BLOCK: Final = 32 << 20
#: Tables begin at cache lines.
_ALIGNMENT: Final = 64


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
        block = np.empty(sum(_padded(sizes[number]) for number in numbers), np.uint8)
        start = 0
        for number in numbers:
            tables[number] = block[start : start + sizes[number]].view(kinds[number][0])
            start += _padded(sizes[number])
    return [
        tables[number] if number in tables else np.empty(rows, dtype)
        for number, (dtype, rows) in enumerate(kinds)
    ]


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
