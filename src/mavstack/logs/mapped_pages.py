"""The memory of a mapped file: pages that were read stay in the process until they are given back."""

from __future__ import annotations

import mmap
from typing import Final

#: Bytes of a file that are read before their memory pages are released.
STEP: Final = 32 << 20


def release(data: mmap.mmap | bytes, start: int, end: int) -> None:
    """Give the pages of a part of a mapped file back; a later access reads them again.

    Args:
        data: The mapped file; for bytes in memory, and on systems without `madvise`, nothing happens.
        start: Beginning of the part in bytes.
        end: End of the part in bytes.
    """
    if not isinstance(data, mmap.mmap) or not hasattr(mmap, "MADV_DONTNEED"):
        return
    first = start // mmap.PAGESIZE * mmap.PAGESIZE
    if end > first:
        data.madvise(mmap.MADV_DONTNEED, first, end - first)
