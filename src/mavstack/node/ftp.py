"""The files of a remote component: `component.ftp`."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.node.api_object import ReadOnly
from mavstack.services.ftp import FtpClient
from mavstack.services.ftp.operations import MAX_BYTES, MAX_ENTRIES

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node.clients import ComponentClients
    from mavstack.services import Operation
    from mavstack.services.ftp import Entry

Result = TypeVar("Result")


class Ftp(ReadOnly):
    """The files of a remote component, by MAVLink FTP (FILE_TRANSFER_PROTOCOL).

    Every method raises `FileDenied` if the component refuses (its `code` is the FTP error), `FileTimeout` if
    it does not answer, and `RemoteCancelled` if the node is closed during the call.
    """

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients

    @property
    def _client(self) -> FtpClient:
        return self._clients.get(FtpClient)

    async def list(
        self, path: str = "/", *, max_entries: int = MAX_ENTRIES, timeout: float | None = None
    ) -> tuple[Entry, ...]:
        """List a directory.

        Args:
            path: The directory.
            max_entries: The largest accepted number of entries.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.

        Returns:
            Its files and directories, without "." and "..", which some servers list too.

        Raises:
            FileDenied: The component refused, for instance because there is no such directory.
            FileTimeout: The component does not answer.
            RemoteProtocolError: The directory has more entries than allowed.
        """
        entries = await self._finish(
            self._client.list_directory(path, self._now(), max_entries=max_entries, timeout=timeout)
        )
        return tuple(entry for entry in entries if entry.name not in (".", ".."))

    async def download(
        self,
        path: str,
        *,
        offset: int = 0,
        size: int | None = None,
        max_size: int = MAX_BYTES,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> bytes:
        """Download a file, or a part of it. A whole file is verified by its checksum.

        Args:
            path: The file.
            offset: The first byte to download.
            size: The number of bytes to download; None: to the end of the file.
            max_size: The largest accepted size in bytes, whatever the component announces.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the bytes received and the bytes in total.

        Returns:
            The bytes.

        Raises:
            FileDenied: The component refused, for instance because there is no such file.
            FileTimeout: The component does not answer, or sends too slowly.
            RemoteProtocolError: The file is larger than allowed, or changed during the download.
        """
        operation = self._client.download(
            path, self._now(), offset=offset, size=size, max_size=max_size, timeout=timeout
        )
        return await self._finish(operation, progress)

    async def upload(
        self,
        path: str,
        data: bytes,
        *,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> None:
        """Create a file, or replace its content. The content is verified by its checksum.

        Args:
            path: The file.
            data: Its new content.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the bytes sent and the bytes in total.

        Raises:
            FileDenied: The component refused, for instance because its storage is full.
            FileTimeout: The component does not answer.
        """
        await self._finish(self._client.upload(path, data, self._now(), timeout=timeout), progress)

    async def checksum(self, path: str, *, timeout: float | None = None) -> int:
        """Get the CRC-32 of a file, as MAVLink FTP computes it.

        Args:
            path: The file.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The CRC-32.

        Raises:
            FileDenied: The component refused.
            FileTimeout: The component does not answer.
        """
        operation = self._client.checksum(path, self._now(), timeout=timeout)
        await self._finish(operation)
        return operation.crc

    async def remove(self, path: str, *, timeout: float | None = None) -> None:
        """Remove a file.

        Args:
            path: The file.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            FileDenied: The component refused.
            FileTimeout: The component does not answer.
        """
        await self._finish(self._client.remove(path, self._now(), timeout=timeout))

    async def rename(self, path: str, to: str, *, timeout: float | None = None) -> None:
        """Rename or move a file or a directory.

        Args:
            path: The present path.
            to: The new path.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            FileDenied: The component refused.
            FileTimeout: The component does not answer.
        """
        await self._finish(self._client.rename(path, to, self._now(), timeout=timeout))

    async def truncate(self, path: str, size: int, *, timeout: float | None = None) -> None:
        """Cut a file to a length.

        Args:
            path: The file.
            size: The new length in bytes.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            FileDenied: The component refused.
            FileTimeout: The component does not answer.
        """
        await self._finish(self._client.truncate(path, size, self._now(), timeout=timeout))

    async def make_directory(self, path: str, *, timeout: float | None = None) -> None:
        """Create a directory.

        Args:
            path: The directory.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            FileDenied: The component refused, for instance because the directory exists.
            FileTimeout: The component does not answer.
        """
        await self._finish(self._client.make_directory(path, self._now(), timeout=timeout))

    async def remove_directory(self, path: str, *, timeout: float | None = None) -> None:
        """Remove an empty directory.

        Args:
            path: The directory.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            FileDenied: The component refused.
            FileTimeout: The component does not answer.
        """
        await self._finish(self._client.remove_directory(path, self._now(), timeout=timeout))

    def _now(self) -> float:
        return self._clients.host.now()

    async def _finish(
        self, operation: Operation[Result], progress: Callable[[int, int], None] | None = None
    ) -> Result:
        return await self._clients.host.finish(self._client, operation, progress)
