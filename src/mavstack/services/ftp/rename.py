"""Renaming a file or a directory.

A server that does not store its replies executes a repeated request again. If the acknowledgement of the
first request was lost, the repetition finds no source, as for a path that never existed. The listing of the
target's directory decides between the two.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.errors import FileDenied, RemoteError
from mavstack.services.ftp.exchange import error_kind
from mavstack.services.ftp.operations import ListDirectory, PathOperation
from mavstack.services.ftp.payload import FtpError, FtpPayload, Opcode

if TYPE_CHECKING:
    from collections.abc import Generator

    from mavstack.services.operation import Operation


class RenamePath(PathOperation):
    """The rename of a file or a directory; see `FtpClient.rename`."""

    def __init__(self, path: str, to: str, *, timeout: float | None = None) -> None:
        super().__init__(f"renaming {path} to {to} on", Opcode.RENAME, path, other=to, timeout=timeout)
        self._directory, _, self._name = to.rstrip("/").rpartition("/")

    def steps(self) -> Generator[Operation[Any], Any, FtpPayload]:
        try:
            return (yield from super().steps())
        except FileDenied as error:
            is_repetition = (
                error.attempts > 1 and error_kind(error.code, error.errno) == FtpError.FILENOTFOUND
            )
            if not (is_repetition and (yield from self._target_exists())):
                raise
        return FtpPayload(0, Opcode.ACK, req_opcode=Opcode.RENAME)

    def _target_exists(self) -> Generator[Operation[Any], Any, bool]:
        try:
            entries = yield ListDirectory(self._directory or "/")
        except RemoteError:
            return False
        return any(entry.name == self._name for entry in entries)
