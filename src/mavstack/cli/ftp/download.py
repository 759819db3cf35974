"""The download of a file from a vehicle: complete or absent, and resumed after an interruption.

The data is written to `.NAME.part` beside the target, which is renamed when it is complete. A large file is
downloaded in pieces of a few seconds each; the next download begins where the last complete piece ended. The
checksum of the vehicle decides whether the pieces belong to one file; if it differs, or the vehicle has none,
the file is downloaded from its beginning.
"""

from __future__ import annotations

from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from mavstack.atomic_file import write_file_atomically
from mavstack.cli.common.errors import CommandError, failure_text
from mavstack.cli.common.text import size_text
from mavstack.errors import FileDenied, RemoteError, RemoteProtocolError, RemoteTimeout
from mavstack.services.ftp import file_crc32

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.cli.ftp.limited import LimitedFtp

#: Sizes of the first and of the largest piece of a download, in bytes.
MIN_PIECE, MAX_PIECE = 1 << 16, 1 << 23
#: Seconds; after a piece that arrives in less time, the next piece is twice as large.
_SHORT_TIME = 5.0
_BLOCK = 1 << 20


class Download:
    """The download of one file; `size` is its size in the directory, 0 if it is not known."""

    def __init__(
        self,
        ftp: LimitedFtp,
        path: str,
        target: Path,
        size: int = 0,
        progress: Callable[[int, int], None] | None = None,
    ) -> None:
        self._ftp = ftp
        self._path = path
        self._target = target
        self._part = target.with_name(f".{target.name}.part")
        self._size = size
        self._progress = progress

    async def run(self) -> int:
        """Download the file and return its size in bytes.

        Raises:
            RemoteError: The vehicle refused, fell silent, or the file changed during the download.
            OSError: The local file cannot be written.
        """
        if self._size <= MIN_PIECE:
            self._part.unlink(missing_ok=True)
            data = await self._ftp.download(self._path, self._size, self._progress)
            write_file_atomically(self._target, data)
            return len(data)
        resumed = self._kept() > 0
        await self._download_pieces()
        verified = await self._verify(resumed)
        if resumed and not verified:
            self._part.unlink()
            await self._download_pieces()
            verified = await self._verify(resumed=False)
        if not verified:
            self._part.unlink()
            raise self._changed("its checksum differs: the file changes")
        self._part.replace(self._target)
        return self._size

    async def _download_pieces(self) -> None:
        """Append pieces until the file is complete."""
        kept, piece = self._kept(), MIN_PIECE
        with self._part.open("ab") as file:
            while kept < self._size:
                started = monotonic()
                data = await self._piece(kept, min(piece, self._size - kept))
                file.write(data)
                file.flush()
                kept += len(data)
                if monotonic() - started < _SHORT_TIME:
                    piece = min(piece * 2, MAX_PIECE)

    async def _piece(self, offset: int, size: int) -> bytes:
        def report_progress(done: int, _: int) -> None:
            if self._progress is not None:
                self._progress(min(offset + done, self._size), self._size)

        report_progress(0, 0)
        try:
            data = await self._ftp.download_piece(self._path, offset, size, report_progress)
        except RemoteError as error:
            if offset == 0:
                raise
            raise CommandError(
                f"{failure_text(error)}; run it again to resume at {size_text(offset)}"
            ) from error
        if len(data) != size:
            self._part.unlink()
            raise self._changed("it became shorter")
        return data

    def _changed(self, answer: str) -> RemoteProtocolError:
        return RemoteProtocolError(f"downloading {self._path} from", "the vehicle", answer=answer)

    async def _verify(self, resumed: bool) -> bool:
        """Compare the checksums; a vehicle that computes none is trusted unless the download was resumed."""
        try:
            theirs = await self._ftp.checksum(self._path)
        except FileDenied:
            return not resumed
        except RemoteTimeout:  # the vehicle may take too long for the checksum of a large file
            if resumed:
                raise
            return True
        ours = 0
        with self._part.open("rb") as file:
            while block := file.read(_BLOCK):
                ours = file_crc32(block, ours)
        return ours == theirs

    def _kept(self) -> int:
        """Return the number of bytes from an earlier download; more than the file has are of another file."""
        try:
            kept = self._part.stat().st_size
        except OSError:
            return 0
        if kept > self._size:
            self._part.unlink()
            return 0
        return kept


def target_for(local: str | None, name: str) -> Path:
    """Return the local path of a download: the given path, or `name` in the given or current directory."""
    path = Path(local or ".")
    return path / name if path.is_dir() or (local or "").endswith(("/", "\\")) else path
