"""The quota of a directory on disk: the bytes and the number of entries that clients may fill.

The directory is scanned once, at the first growth; later changes are added up. Other programs may change it
too, so it is scanned again before a growth is refused, but not for each of many refusals. Sizes count as they
are listed: a file with a hole counts in full. A file that is removed while it is open counts until it is
closed.
"""

from __future__ import annotations

import os
from collections import Counter
from errno import ENOSPC

#: The number of refusals after which the directory is scanned again.
REFUSALS_PER_SCAN = 64

FileId = tuple[int, int]


class Quota:
    """The quota of one directory.

    Args:
        root: The directory.
        capacity: The bytes of all files together; None sets no limit on bytes and entries.
        max_entries: The number of files and directories.
    """

    def __init__(self, root: os.PathLike[str], capacity: int | None, max_entries: int) -> None:
        self._root = root
        self._capacity = capacity
        self._max_entries = max_entries
        self._used: int | None = None  # None: not scanned yet
        self._entries = 0
        self._refusals = 0
        self._open: Counter[FileId] = Counter()
        self._removed: dict[FileId, int] = {}

    def check_growth(self, growth: int, entries: int = 0) -> None:
        """Raise OSError if there is no room for these bytes and entries."""
        if self._capacity is None or (growth <= 0 and entries <= 0):
            return
        if self._used is None:
            self._scan()
        if self._has_room(growth, entries):
            return
        if self._refusals % REFUSALS_PER_SCAN == 0:
            self._scan()
        if self._has_room(growth, entries):
            self._refusals = 0
            return
        self._refusals += 1
        raise OSError(ENOSPC, "the store is full")

    def changed(self, growth: int, entries: int = 0) -> None:
        """Record that the files grew by these bytes and entries; negative: that they shrank."""
        if self._used is not None:
            self._used = max(self._used + growth, 0)
            self._entries = max(self._entries + entries, 0)

    def opened(self, known: os.stat_result) -> None:
        """Record that a file was opened."""
        self._open[known.st_dev, known.st_ino] += 1

    def closed(self, known: os.stat_result) -> None:
        """Record that a file was closed."""
        number = known.st_dev, known.st_ino
        self._open[number] -= 1
        if self._open[number] <= 0:
            del self._open[number]
            if number in self._removed:
                del self._removed[number]
                self.changed(-known.st_size)

    def removed(self, known: os.stat_result) -> None:
        """Record that a file was removed."""
        number = known.st_dev, known.st_ino
        if known.st_nlink > 1:
            self.changed(0, -1)
        elif number in self._open:
            self._removed[number] = known.st_size
            self.changed(0, -1)
        else:
            self.changed(-known.st_size, -1)

    def _has_room(self, growth: int, entries: int) -> bool:
        return self._capacity is None or (
            ((self._used or 0) + growth <= self._capacity or growth <= 0)
            and (self._entries + entries <= self._max_entries or entries <= 0)
        )

    def _scan(self) -> None:
        used, found = sum(self._removed.values()), 0
        for folder, directories, names in os.walk(self._root):
            found += len(directories) + len(names)
            if self._capacity is not None and found > self._max_entries:
                # counts as full; the rest need not be scanned
                self._used, self._entries = self._capacity, found
                return
            for name in names:
                try:
                    used += os.lstat(os.path.join(folder, name)).st_size  # noqa: PTH118 (may be many)
                except OSError:
                    continue
        self._used, self._entries = used, found
