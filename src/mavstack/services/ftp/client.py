"""The FTP client of one component."""

from __future__ import annotations

from mavstack.services.ftp.operations import (
    MAX_BYTES,
    MAX_ENTRIES,
    ComputeChecksum,
    DownloadFile,
    EndSession,
    FtpSessionClient,
    ListDirectory,
    PathOperation,
    UploadFile,
)
from mavstack.services.ftp.payload import Opcode
from mavstack.services.ftp.rename import RenamePath


class FtpClient(FtpSessionClient):
    """The FTP client of one component."""

    def download(
        self,
        path: str,
        now: float,
        *,
        offset: int = 0,
        size: int | None = None,
        verify: bool | None = None,
        max_size: int = MAX_BYTES,
        timeout: float | None = None,
    ) -> DownloadFile:
        """Download a file or a part of it.

        Args:
            path: The path on the server.
            now: The time, Unix seconds.
            offset: Where to begin, bytes.
            size: The number of bytes; None: up to the end.
            verify: Compare the checksum of a whole file, if the server supports it. None: unless the path
                begins with @, since such virtual files are generated for each request.
            max_size: The largest accepted size, bytes.
            timeout: Seconds for the whole operation; None sets no overall limit.

        Returns:
            The operation, whose result is the content. It may fail with FileDenied, FileTimeout or
            RemoteProtocolError (the file changed, or is too large).

        Raises:
            InvalidArgumentError: The path, the offset or the size is invalid.
        """
        operation = DownloadFile(
            path, offset=offset, size=size, verify=verify, max_size=max_size, timeout=timeout
        )
        return self.begin(operation, now)

    def upload(
        self, path: str, data: bytes, now: float, *, verify: bool = True, timeout: float | None = None
    ) -> UploadFile:
        """Upload a file, replacing an existing one; `verify` compares its checksum afterwards."""
        return self.begin(UploadFile(path, data, verify=verify, timeout=timeout), now)

    def list_directory(
        self,
        path: str,
        now: float,
        *,
        with_time: bool = False,
        max_entries: int = MAX_ENTRIES,
        timeout: float | None = None,
    ) -> ListDirectory:
        """List a directory; the result is a tuple of `Entry`, with modification times if supported.

        It fails with RemoteProtocolError if there are more than `max_entries`.
        """
        operation = ListDirectory(path, with_time=with_time, max_entries=max_entries, timeout=timeout)
        return self.begin(operation, now)

    def checksum(self, path: str, now: float, *, timeout: float | None = None) -> ComputeChecksum:
        """Request the CRC-32 of a file; it is the operation's `crc`."""
        return self.begin(ComputeChecksum(path, timeout=timeout), now)

    def remove(self, path: str, now: float, *, timeout: float | None = None) -> PathOperation:
        """Remove a file."""
        return self._begin_path_operation(
            f"removing {path} on", Opcode.REMOVEFILE, path, now, timeout=timeout
        )

    def rename(self, path: str, to: str, now: float, *, timeout: float | None = None) -> RenamePath:
        """Rename or move a file or directory."""
        return self.begin(RenamePath(path, to, timeout=timeout), now)

    def truncate(self, path: str, size: int, now: float, *, timeout: float | None = None) -> PathOperation:
        """Set the size of a file, bytes."""
        return self._begin_path_operation(
            f"truncating {path} on", Opcode.TRUNCATEFILE, path, now, offset=size, timeout=timeout
        )

    def make_directory(self, path: str, now: float, *, timeout: float | None = None) -> PathOperation:
        """Make a directory."""
        return self._begin_path_operation(
            f"making directory {path} on", Opcode.CREATEDIRECTORY, path, now, timeout=timeout
        )

    def remove_directory(self, path: str, now: float, *, timeout: float | None = None) -> PathOperation:
        """Remove an empty directory."""
        return self._begin_path_operation(
            f"removing directory {path} on", Opcode.REMOVEDIRECTORY, path, now, timeout=timeout
        )

    def reset_sessions(self, now: float) -> EndSession:
        """Close all sessions; a server with one session for all clients closes that one."""
        return self.begin(EndSession(None, self.server), now)

    def _begin_path_operation(
        self,
        description: str,
        opcode: int,
        path: str,
        now: float,
        *,
        offset: int = 0,
        timeout: float | None = None,
    ) -> PathOperation:
        return self.begin(PathOperation(description, opcode, path, offset=offset, timeout=timeout), now)
