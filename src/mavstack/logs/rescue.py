"""The interface of repairs: a format finds the sound records of a damaged file and returns them in order."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

from mavstack.logs.damage import LogDamage

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.logs.log_bytes import LogBytes


class Rescue(ABC):
    """Finds the sound records of a file.

    Args:
        data: The bytes of the file.

    Attributes:
        records: Number of records that were found.
        damage: Counts of everything else; complete after the last piece.
    """

    def __init__(self, data: LogBytes) -> None:
        self.data = data
        self.records = 0
        self.damage = LogDamage()

    @abstractmethod
    def pieces(self, progress: Callable[[int, int], None]) -> Iterator[bytes]:
        """Yield the content of a sound file with these records, piece by piece.

        Args:
            progress: Called with the bytes that were read, and with the size of the file.

        Yields:
            Bytes of the new file.

        Raises:
            LogError: The file cannot be read.
        """
