"""The upload of a file to a vehicle: complete or absent, like a download.

The data is written to `NAME.part` beside the target, which is renamed when its checksum was compared. Most
autopilots do not rename over another file: the old one is removed first. An upload that ends early, by an
error or by Ctrl-C, removes its part. Files with a meaning of their own, such as ArduPilot's `@PARAM`, and
files on servers that cannot rename, are written in place.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError, failure_text
from mavstack.cli.common.output import echo
from mavstack.cli.ftp.paths import join, split
from mavstack.errors import FileDenied, RemoteError
from mavstack.services.ftp import FtpError

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.cli.ftp.limited import LimitedFtp
    from mavstack.vehicle import Vehicle

PART_SUFFIX: Final = ".part"
#: Seconds to remove an incomplete file (`.part`); then the command ends without removing it.
REMOVE_TIMEOUT: Final = 3.0


class Upload:
    """The upload of one file."""

    def __init__(self, vehicle: Vehicle, ftp: LimitedFtp, path: str) -> None:
        self._files = vehicle.ftp
        self._ftp = ftp
        self._path = path
        self._directory, self._name = split(path)
        self._part_name = self._name + PART_SUFFIX
        self._part = join(self._directory, self._part_name)

    async def run(self, data: bytes, progress: Callable[[int, int], None] | None = None) -> None:
        """Create the file, or replace it.

        Raises:
            RemoteError: The vehicle refused, or does not answer.
            CommandError: As above, and the part of the file may remain on the vehicle.
        """
        if "@" in self._path:
            await self._write(self._path, data, progress)
            return
        try:
            await self._write(self._part, data, progress)
            renamed = await self._rename(data, progress)
        except (RemoteError, asyncio.CancelledError) as error:
            if not await self._remove_part() and isinstance(error, RemoteError):
                text = f"{failure_text(error)}; {self._part} may remain on the vehicle"
                raise CommandError(text) from error
            raise
        if not renamed:
            await self._replace()

    async def _write(self, path: str, data: bytes, progress: Callable[[int, int], None] | None) -> None:
        await self._files.upload(path, data, timeout=self._ftp.remaining_time(), progress=progress)

    async def _rename(self, data: bytes, progress: Callable[[int, int], None] | None) -> bool:
        """Rename the part; return False if another file is in the way."""
        try:
            await self._files.rename(self._part, self._path, timeout=self._ftp.remaining_time())
        except FileDenied as error:
            if error.code == FtpError.UNKNOWNCOMMAND:
                await self._write(self._path, data, progress)
                await self._remove_part()
                return True
            names = {entry.name for entry in await self._ftp.list(self._directory or "/")}
            if self._name not in names:
                raise
            # true: the file was renamed, but the acknowledgement was lost
            return self._part_name not in names
        return True

    async def _replace(self) -> None:
        """Replace the old file by the part; the part stays until this is done."""
        try:
            await self._files.remove(self._path, timeout=self._ftp.remaining_time())
            await self._files.rename(self._part, self._path, timeout=self._ftp.remaining_time())
        except RemoteError as error:
            raise CommandError(f"{failure_text(error)}; the complete file is {self._part}") from error
        except asyncio.CancelledError:
            echo(f"interrupted: the complete file is {self._part}", error=True)
            raise

    async def _remove_part(self) -> bool:
        """Remove the part from the vehicle; return False if it may remain."""
        try:
            await self._files.remove(self._part, timeout=REMOVE_TIMEOUT)
        except FileDenied as error:
            return error.code == FtpError.FILENOTFOUND
        except RemoteError:
            return False
        return True
