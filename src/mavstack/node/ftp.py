"""The files on a component, by MAVLink FTP."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

from mavstack.services.ftp import FtpClient

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.component import RemoteComponent
    from mavstack.services import Operation
    from mavstack.services.ftp import Entry

Result = TypeVar("Result")


class Ftp:
    """The files of one component; raises `FileDenied` or `FileTimeout`."""

    def __init__(self, remote: RemoteComponent) -> None:
        self._remote = remote

    @cached_property
    def client(self) -> FtpClient:
        """The state machine behind it."""
        return self._remote.node.serve(FtpClient(self._remote.node.address, self._remote.address))

    async def list(self, path: str = "/", *, timeout: float | None = None) -> tuple[Entry, ...]:
        """What is in a directory, without itself and its parent, which some servers list too."""
        entries = await self._finish(self.client.list_directory(path, self._now(), timeout=timeout))
        return tuple(entry for entry in entries if entry.name not in (".", ".."))

    async def download(
        self,
        path: str,
        *,
        offset: int = 0,
        size: int | None = None,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> bytes:
        """Read a file, or `size` bytes from `offset`; a whole one is compared by checksum."""
        operation = self.client.read_file(path, self._now(), offset=offset, size=size, timeout=timeout)
        return await self._finish(operation, progress)

    async def upload(
        self,
        path: str,
        data: bytes,
        *,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> None:
        """Create a file, or replace what it holds; compared by checksum."""
        await self._finish(self.client.write_file(path, data, self._now(), timeout=timeout), progress)

    async def checksum(self, path: str, *, timeout: float | None = None) -> int:
        """The CRC-32 of a file, as MAVLink FTP computes it."""
        operation = self.client.crc(path, self._now(), timeout=timeout)
        await self._finish(operation)
        return operation.crc

    async def remove(self, path: str, *, timeout: float | None = None) -> None:
        """Remove a file."""
        await self._finish(self.client.remove(path, self._now(), timeout=timeout))

    async def rename(self, path: str, to: str, *, timeout: float | None = None) -> None:
        """Rename or move a file or a directory."""
        await self._finish(self.client.rename(path, to, self._now(), timeout=timeout))

    async def truncate(self, path: str, size: int, *, timeout: float | None = None) -> None:
        """Make a file that long."""
        await self._finish(self.client.truncate(path, size, self._now(), timeout=timeout))

    async def make_directory(self, path: str, *, timeout: float | None = None) -> None:
        """Make a directory."""
        await self._finish(self.client.make_directory(path, self._now(), timeout=timeout))

    async def remove_directory(self, path: str, *, timeout: float | None = None) -> None:
        """Remove an empty directory."""
        await self._finish(self.client.remove_directory(path, self._now(), timeout=timeout))

    def _now(self) -> float:
        return self._remote.node.now()

    async def _finish(
        self, operation: Operation[Result], progress: Callable[[int, int], None] | None = None
    ) -> Result:
        return await self._remote.node.driver.finish(self.client, operation, progress)
