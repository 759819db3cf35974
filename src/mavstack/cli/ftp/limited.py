"""Reading the files of a vehicle within the limits of a command: --max-size, --max-entries, --action-timeout.

A listing and the file that it names come from the remote end of a link. A file may be longer than listed, a
directory may have no end, and both may arrive so slowly that a download never ends. The API bounds each call;
the options of a command apply to all its calls together.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.options import byte_size, seconds
from mavstack.cli.common.text import size_text
from mavstack.node.time_budget import TimeBudget
from mavstack.services.ftp.operations import MAX_BYTES, MAX_ENTRIES

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Iterable

    from mavstack.services.ftp import Entry
    from mavstack.vehicle import Vehicle

#: Bytes by which the download of a growing file may exceed twice its listed size.
MAX_GROWTH = 1 << 20


def add_timeout_option(parser: ArgumentParser) -> None:
    """Declare `--action-timeout` of a transfer."""
    parser.add_argument(
        "--action-timeout",
        type=seconds,
        metavar="SECONDS",
        help="time for the whole action (default: as long as it makes progress)",
    )


def add_entries_option(parser: ArgumentParser) -> None:
    """Declare `--max-entries`."""
    parser.add_argument(
        "--max-entries",
        type=int,
        default=MAX_ENTRIES,
        metavar="N",
        help=f"fail at a tree of more files and directories (default: {MAX_ENTRIES})",
    )


def add_size_option(parser: ArgumentParser, text: str) -> None:
    """Declare `--max-size`."""
    parser.add_argument("--max-size", type=byte_size, metavar="BYTES", help=text)


class LimitedFtp:
    """The files of a vehicle, read within the limits of a command."""

    def __init__(self, vehicle: Vehicle, arguments: Namespace) -> None:
        self._ftp = vehicle.ftp
        self._max_size: int | None = getattr(arguments, "max_size", None)
        self._budget = TimeBudget(getattr(arguments, "action_timeout", None), vehicle.connection.now)
        #: The largest number of files and directories in a listing, and in a directory tree.
        self.max_entries: int = getattr(arguments, "max_entries", MAX_ENTRIES)

    def remaining_time(self) -> float | None:
        """Return the seconds that are left for the command; None for no limit."""
        return self._budget.remaining()

    async def list(self, path: str) -> tuple[Entry, ...]:
        """List a directory; see `Ftp.list`."""
        return await self._ftp.list(path, max_entries=self.max_entries, timeout=self.remaining_time())

    async def checksum(self, path: str) -> int:
        """Get the checksum of a file; see `Ftp.checksum`."""
        return await self._ftp.checksum(path, timeout=self.remaining_time())

    async def download(
        self, path: str, listed: int, progress: Callable[[int, int], None] | None = None
    ) -> bytes:
        """Download a small file; it may be somewhat larger than listed, since it may be written meanwhile."""
        limit = self._max_size
        if limit is None:
            limit = 2 * listed + MAX_GROWTH if listed else MAX_BYTES
        return await self._ftp.download(
            path, max_size=limit, timeout=self.remaining_time(), progress=progress
        )

    async def download_piece(
        self, path: str, offset: int, size: int, progress: Callable[[int, int], None]
    ) -> bytes:
        """Download a piece of a file."""
        return await self._ftp.download(
            path, offset=offset, size=size, timeout=self.remaining_time(), progress=progress
        )

    def check_sizes(self, entries: Iterable[Entry], name: str) -> None:
        """Raise `CommandError` if the listed sizes of the files exceed `--max-size` together."""
        limit = MAX_BYTES if self._max_size is None else self._max_size
        total = sum(entry.size for entry in entries)
        if total > limit:
            sizes = f"{size_text(total)}, more than the {size_text(limit)} allowed"
            raise CommandError(f"{name} has {sizes}; --max-size allows more")
