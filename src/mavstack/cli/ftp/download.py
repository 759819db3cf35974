"""Fetching a file of a vehicle: never half a file under its name, and a long one goes on where it stopped.

What has come lies in `.NAME.part` beside the target and takes its name when it is whole. A large file comes
in pieces of a few seconds each; if the transfer breaks, the next one begins where the last piece ended.
Whether the pieces belong together the checksum of the vehicle decides; without one, or if it is another, the
file is fetched from its beginning.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from mavstack.cli.common.transfer_progress import size_text
from mavstack.errors import FileDenied, MavstackError, RemoteError, RemoteProtocolError, RemoteTimeout
from mavstack.services.ftp import file_crc32

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.ftp import Ftp

FIRST_PIECE, LARGEST_PIECE = 1 << 16, 1 << 23
#: A piece that came faster than this is followed by one twice as large, in seconds.
_SHORT = 5.0
_BLOCK = 1 << 20


class Download:
    """The download of one file; `size` is what its directory tells, 0 if that is not known."""

    def __init__(
        self,
        files: Ftp,
        path: str,
        target: Path,
        size: int = 0,
        progress: Callable[[int, int], None] | None = None,
    ) -> None:
        self._files = files
        self._path = path
        self._target = target
        self._part = target.with_name(f".{target.name}.part")
        self._size = size
        self._progress = progress

    async def run(self) -> int:
        """Fetch it; gives how many bytes it has."""
        if self._size <= FIRST_PIECE:
            self._part.unlink(missing_ok=True)
            data = await self._files.download(self._path, progress=self._progress)
            try:
                self._part.write_bytes(data)
                self._part.replace(self._target)
            finally:
                with suppress(OSError):
                    self._part.unlink(missing_ok=True)
            return len(data)
        resumed = self._kept() > 0
        await self._fetch()
        right = await self._is_right(resumed)
        if resumed and not right:
            self._part.unlink()
            await self._fetch()
            right = await self._is_right(resumed=False)
        if not right:
            self._part.unlink()
            raise RemoteProtocolError(
                f"reading {self._path}", "the vehicle", answer="its checksum is another: it changes"
            )
        self._part.replace(self._target)
        return self._size

    async def _fetch(self) -> None:
        """Append pieces until it is whole."""
        kept, piece = self._kept(), FIRST_PIECE
        with self._part.open("ab") as file:
            while kept < self._size:
                began = monotonic()
                data = await self._piece(kept, min(piece, self._size - kept))
                file.write(data)
                file.flush()
                kept += len(data)
                if monotonic() - began < _SHORT:
                    piece = min(piece * 2, LARGEST_PIECE)

    async def _piece(self, offset: int, size: int) -> bytes:
        def told(done: int, _: int) -> None:
            if self._progress is not None:
                self._progress(min(offset + done, self._size), self._size)

        told(0, 0)
        try:
            data = await self._files.download(self._path, offset=offset, size=size, progress=told)
        except RemoteError as error:
            if offset == 0:
                raise
            raise MavstackError(f"{error}; run it again to go on from {size_text(offset)}") from error
        if len(data) != size:
            self._part.unlink()
            raise RemoteProtocolError(f"reading {self._path}", "the vehicle", answer="it became shorter")
        return data

    async def _is_right(self, resumed: bool) -> bool:
        """Whether the vehicle's checksum is ours; one that it cannot make is no objection to one piece."""
        try:
            theirs = await self._files.checksum(self._path)
        except FileDenied:
            return not resumed
        except RemoteTimeout:  # a large file may take too long
            if resumed:
                raise
            return True
        ours = 0
        with self._part.open("rb") as file:
            while block := file.read(_BLOCK):
                ours = file_crc32(block, ours)
        return ours == theirs

    def _kept(self) -> int:
        """How much of it came before; more than there is belongs to another file."""
        try:
            kept = self._part.stat().st_size
        except OSError:
            return 0
        if kept > self._size:
            self._part.unlink()
            return 0
        return kept


def target_for(local: str | None, name: str) -> Path:
    """Where a file of the vehicle goes: to the path given, into the directory given, or here."""
    path = Path(local or ".")
    return path / name if path.is_dir() or (local or "").endswith(("/", "\\")) else path
