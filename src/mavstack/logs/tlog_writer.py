"""Writing of tlogs that survive a crash: complete records only, in the hands of the system after each call.

A record is 8 bytes of time (microseconds since 1970, big-endian) and a packet. The records of one call are
one `write` to an unbuffered file, so a program that is killed leaves no partial record; if the disk is full,
the part of a record that was written is cut off again. An existing file is never overwritten. Keys, passwords
and PINs are blanked.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.errors import LogError
from mavstack.security import redact

if TYPE_CHECKING:
    from collections.abc import Iterable
    from types import TracebackType
    from typing import Self

    from mavstack.wire import Packet

_TIMESTAMP: Final = 8
_MAX_TIME: Final = 2**63 - 1
#: Microseconds by which packets of several links may arrive out of order; times that jump slow down a replay.
_MAX_DISORDER: Final = 1_000_000


class TlogWriter:
    """A new tlog, open for writing; a context manager that closes it.

    Args:
        path: Path of the new file.

    Raises:
        LogError: The file exists, or cannot be created.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        #: Packets in the file.
        self.packets = 0
        try:
            self._file = self.path.open("xb", buffering=0)
        except FileExistsError:
            raise LogError(f"{path}: it exists, and a recording never overwrites a file") from None
        except OSError as error:
            raise LogError(f"{path}: {error.strerror or error}") from None
        self._size = 0
        self._last_time = 0

    def write(self, packets: Iterable[Packet], unix_time: float) -> None:
        """Write packets that were received at one time.

        Args:
            packets: The packets.
            unix_time: The Unix time in seconds.

        Raises:
            LogError: The file cannot be written; it keeps the complete records.
        """
        stamp = self._in_order(min(max(int(unix_time * 1e6), 0), _MAX_TIME)).to_bytes(_TIMESTAMP, "big")
        records = [stamp + redact(packet) for packet in packets]
        data = b"".join(records)
        try:
            written = self._file.write(data)
            if written != len(data):
                raise OSError(f"only {written} of {len(data)} bytes were written")
        except OSError as error:
            self._cut_off()
            raise LogError(
                f"{self.path}: {error.strerror or error}; {self.packets} packets are kept"
            ) from None
        self._size += len(data)
        self.packets += len(records)

    def sync(self) -> None:
        """Wait until the system has stored the file on the disk, so that it survives a loss of power."""
        if not self._file.closed:
            os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file. Idempotent."""
        self._file.close()

    def _in_order(self, time: int) -> int:
        """Return a time that is not before the last one, unless the clock was set back."""
        if 0 < self._last_time - time < _MAX_DISORDER:
            return self._last_time
        self._last_time = time
        return time

    def _cut_off(self) -> None:
        """Remove a record that was written partly."""
        self._file.truncate(self._size)
        self._file.seek(self._size)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
