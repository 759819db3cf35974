"""Memory of large tables, which is used again after the tables are dropped.

The kernel clears each page before a process gets it, which takes as long as the decoding of the rows that
fill it. An export of a large log, or a program that reads one log after the other, therefore gets the memory
of the tables that it dropped. The kernel may take this memory back when it is short of it (`MADV_FREE`).
"""

from __future__ import annotations

import mmap
import sys
import weakref
from threading import RLock
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Maximum size in bytes of the memory that is kept for reuse.
MAX_WAITING: Final = 512 << 20
#: Maximum share of a reused block that may stay unused.
_MAX_WASTE: Final = 0.25
_ADVICE_IN_USE: Final[int | None] = getattr(mmap, "MADV_HUGEPAGE", None)
_ADVICE_WAITING: Final[int | None] = getattr(mmap, "MADV_FREE", None)


class ReusedMemory:
    """Blocks of memory, some of which wait for their next use.

    Args:
        limit: Maximum size in bytes of the blocks that wait.
    """

    def __init__(self, limit: int = MAX_WAITING) -> None:
        self._limit = limit
        self._waiting: list[mmap.mmap] = []
        # The garbage collector may return a block while the same thread takes one, so the lock must be
        # reentrant.
        self._lock = RLock()

    @property
    def waiting(self) -> int:
        """Size in bytes of the blocks that wait for their next use."""
        return sum(map(len, self._waiting))

    def take(self, size: int) -> NDArray[np.uint8]:
        """Return memory with any content, which is given back when no array uses it any more.

        Args:
            size: Size in bytes, at least 1.
        """
        block = self._waiting_block(size)
        if block is None:
            block = _new_block(size)
        memory = np.frombuffer(block, np.uint8, size)
        weakref.finalize(memory, self._give_back, block).atexit = False
        return memory

    def _waiting_block(self, size: int) -> mmap.mmap | None:
        """Remove the smallest block that fits; if no block fits, make room for a new block."""
        largest = size / (1 - _MAX_WASTE)
        with self._lock:
            fitting = [block for block in self._waiting if size <= len(block) <= largest]
            if fitting:
                block = min(fitting, key=len)
                self._waiting.remove(block)
                return block
            while self._waiting and self.waiting + size > self._limit:
                self._waiting.pop(0)
        return None

    def _give_back(self, block: mmap.mmap) -> None:
        with self._lock:
            if self.waiting + len(block) > self._limit:
                return
            if _ADVICE_WAITING is not None:
                block.madvise(_ADVICE_WAITING)
            self._waiting.append(block)


def _new_block(size: int) -> mmap.mmap:
    if sys.platform == "win32":
        return mmap.mmap(-1, size)
    block = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    if _ADVICE_IN_USE is not None:
        block.madvise(_ADVICE_IN_USE)
    return block
