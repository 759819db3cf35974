"""The operations of an FTP client.

    open ── session ──► transfer ──► close the session ──► compare checksums ──► result

A vehicle that pauses or restarts may lose the session of a download: the file is opened again, and the
missing part is requested. Its checksum shows whether both parts belong to one content.

A server may have one session for all clients (PX4), so operations that open one queue, and every end of an
operation, errors and cancellation included, closes the session: by TERMINATESESSION, or by RESETSESSIONS if
its number is unknown or more than one may have been opened. `NOSESSIONSAVAILABLE` usually means a session
that an earlier run left open; the sessions are reset once.

Modifying operations run alone: a server caches one reply, and another request between a lost acknowledgement
and its repetition would make it execute the request twice.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import common
from mavstack.errors import FileDenied, FileTimeout, InvalidArgumentError, RemoteError, RemoteProtocolError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.ftp.download import DownloadTransfer
from mavstack.services.ftp.entries import Entry, read_entries
from mavstack.services.ftp.exchange import Exchange, ServerState
from mavstack.services.ftp.partial_file import PartialFile
from mavstack.services.ftp.payload import (
    ALL_ONES,
    MAX_DATA,
    FtpError,
    FtpPayload,
    Opcode,
    file_crc32,
    path_bytes,
)
from mavstack.services.ftp.upload import UploadTransfer
from mavstack.services.operation import Client, Operation
from mavstack.services.procedure import Procedure

if TYPE_CHECKING:
    from collections.abc import Generator

Result = TypeVar("Result")
logger = logging.getLogger("mavstack.services")

#: The largest download into memory in bytes, unless the caller allows more.
MAX_BYTES = 1 << 30
#: The largest number of entries of a directory, unless the caller allows more.
MAX_ENTRIES = 10_000
#: The number of interruptions after which a download still continues, if data arrived between them.
MAX_INTERRUPTIONS = 16
LAST_SESSION = 255


class _FtpProcedure(Procedure[Result]):
    """The base of FTP procedures."""

    timeout_error = FileTimeout
    exclusive = False
    modifies = False

    def __init__(self, description: str, path: str, *, timeout: float | None = None) -> None:
        super().__init__(description, timeout=timeout)
        self.path = path
        self._path = path_bytes(path)

    @property
    def ftp(self) -> FtpSessionClient:
        """The client that runs the procedure."""
        if not isinstance(self.client, FtpSessionClient):
            raise InvalidArgumentError(f"{self.description} needs an FtpClient")
        return self.client

    def exchange(self, opcode: int, data: bytes = b"", *, session: int = 0, offset: int = 0) -> Exchange:
        """Return an exchange as a step."""
        payload = FtpPayload.request(opcode, data, session=session, offset=offset)
        return Exchange(self.description, payload, self.ftp.server)

    def remote_crc(self) -> Generator[Operation[Any], Any, int | None]:
        """Request the checksum of the file; returns None if the server does not support it."""
        if self.ftp.server.no_crc:
            return None
        try:
            reply = yield self.exchange(Opcode.CALCFILECRC, self._path)
        except RemoteError as error:
            self.ftp.server.no_crc = isinstance(error, FileDenied) and error.code == FtpError.UNKNOWNCOMMAND
            return None
        return int.from_bytes(reply.data[:4], "little") if reply.size >= 4 else None

    def protocol_error(self, answer: str, *, limit: str = "") -> RemoteProtocolError:
        """Return the error for a file that differs from the transferred data, or exceeds a limit."""
        answer = f"{answer}; {limit}= allows more" if limit else answer
        return RemoteProtocolError(self.description, str(self.target), answer=answer, limit=limit)


class _SessionProcedure(_FtpProcedure[Result]):
    """The base of procedures that open a session."""

    exclusive = True
    min_rate = 32.0
    _session: int | None = None
    _unclear = False  # True if the server may have opened a session whose number is not known

    def open(self, opcode: int) -> Generator[Operation[Any], Any, FtpPayload]:
        """Open the file; resets once the sessions that an earlier run left open."""
        try:
            reply = yield from self._open_once(opcode)
        except FileDenied as error:
            if error.code != FtpError.NOSESSIONSAVAILABLE:
                raise
            yield self.exchange(Opcode.RESETSESSION)
            reply = yield from self._open_once(opcode)
        return reply

    def end_session(self) -> None:
        """Let the client close the session, while only the next session waits for it."""
        session = self._session
        if session is not None or self._unclear:
            self.ftp.end_session(None if self._unclear else session, self.now)
        self._session, self._unclear = None, False

    def clean_up(self, now: float) -> None:
        self._now = now
        super().clean_up(now)
        self.end_session()

    def _open_once(self, opcode: int) -> Generator[Operation[Any], Any, FtpPayload]:
        self._unclear = True
        opening = self.exchange(opcode, self._path, session=self.ftp.new_session())
        try:
            reply: FtpPayload = yield opening
        except FileDenied:
            self._unclear = opening.attempts > 1
            raise
        self._session, self._unclear = reply.session, opening.attempts > 1
        return reply


class DownloadFile(_SessionProcedure[bytes]):
    """The download of a file or a range of it; see `FtpClient.download`."""

    def __init__(
        self,
        path: str,
        *,
        offset: int = 0,
        size: int | None = None,
        verify: bool | None = None,
        max_size: int = MAX_BYTES,
        timeout: float | None = None,
    ) -> None:
        super().__init__(f"downloading {path} from", path, timeout=timeout)
        if offset < 0 or (size is not None and size < 0):
            raise InvalidArgumentError(f"offset and size must not be negative, got {offset} and {size}")
        self.transfer: DownloadTransfer | None = None
        self.verified = False
        self._range = (offset, size)
        self._max_size = max_size
        self._file: PartialFile | None = None
        self._announced = ALL_ONES
        whole = offset == 0 and size is None
        self._verify = (whole and not path.startswith("@")) if verify is None else (verify and whole)

    def steps(self) -> Generator[Operation[Any], Any, bytes]:
        interruptions = received = 0
        while True:
            try:
                announced, data = yield from self._download_missing()
                break
            except (FileDenied, FileTimeout):
                file = self._file
                progress = file is not None and file.received > received
                if file is None or not progress or interruptions >= MAX_INTERRUPTIONS:
                    raise
                interruptions, received = interruptions + 1, file.received
                logger.debug("%s: interrupted at %d of %d bytes", self, received, file.total)
                if self.path.startswith("@"):  # the server generates such a file again for each session
                    self._file, received = None, 0
        if len(data) > self._max_size:
            answer = f"the file has more than the {self._max_size} bytes allowed"
            raise self.protocol_error(answer, limit="max_size")
        if self._verify:
            yield from self._compare(data)
        start, end = self._bounds(announced)
        if len(data) < end - start and not self.verified and announced != ALL_ONES and self.path[:1] != "@":
            raise self.protocol_error("the file is shorter than announced")
        return data

    def _download_missing(self) -> Generator[Operation[Any], Any, tuple[int, bytes]]:
        """Open the file and download its missing part; returns the announced size and the content."""
        try:
            reply = yield from self.open(Opcode.OPENFILERO)
            announced = int.from_bytes(reply.data[:4], "little") if reply.size >= 4 else ALL_ONES
            if self._file is None:
                self._file = PartialFile(*self._bounds(announced))
                self._announced = announced
            elif announced != self._announced:
                raise self.protocol_error("the file changed during an interruption of the download")
            self.transfer = DownloadTransfer(self.description, reply.session, self._file, self.ftp.server)
            data: bytes = yield self.transfer
        finally:
            self.end_session()
        return announced, data

    def child_ended(self, child: Operation[Any], now: float) -> None:
        if child is self.transfer:
            self.report_progress(now)
        super().child_ended(child, now)

    def _bounds(self, announced: int) -> tuple[int, int]:
        offset, size = self._range
        end = announced if size is None else min(offset + size, announced)
        if announced == ALL_ONES:  # the size is not known: one more byte shows that the file is too large
            return offset, min(end, offset + self._max_size + 1)
        if end - offset > self._max_size:
            answer = f"the file has {end - offset} bytes, more than the {self._max_size} allowed"
            raise self.protocol_error(answer, limit="max_size")
        return offset, max(end, offset)

    def _compare(self, data: bytes) -> Generator[Operation[Any], Any, None]:
        crc = yield from self.remote_crc()
        self.verified = crc is not None
        if crc is not None and crc != file_crc32(data):
            raise self.protocol_error("wrong checksum: the file changed during the download")


class UploadFile(_SessionProcedure[None]):
    """The upload of a file; see `FtpClient.upload`."""

    modifies = True

    def __init__(self, path: str, data: bytes, *, verify: bool = True, timeout: float | None = None) -> None:
        super().__init__(f"uploading {path} to", path, timeout=timeout)
        if len(data) > ALL_ONES:
            raise InvalidArgumentError(f"a file must be smaller than 4 GiB, got {len(data)} bytes")
        self.verified = False
        self._data = bytes(data)
        self._verify = verify

    def steps(self) -> Generator[Operation[Any], Any, None]:
        try:
            reply = yield from self.open(Opcode.CREATEFILE)
            yield UploadTransfer(self.description, reply.session, self._data, self.ftp.server)
            yield from self._close(reply.session)
        finally:
            self.end_session()
        crc = (yield from self.remote_crc()) if self._verify else None
        self.verified = crc is not None
        if crc is not None and crc != file_crc32(self._data):
            raise self.protocol_error("wrong checksum: the stored file differs from the uploaded data")

    def _close(self, session: int) -> Generator[Operation[Any], Any, None]:
        """Close the file, so that the data is stored before its checksum is compared."""
        try:
            yield self.exchange(Opcode.TERMINATESESSION, session=session)
        except FileDenied as error:
            if error.code != FtpError.INVALIDSESSION:
                raise
        self._session = None


class ListDirectory(_FtpProcedure[tuple[Entry, ...]]):
    """The listing of a directory; see `FtpClient.list_directory`."""

    min_rate = 0.25

    def __init__(
        self,
        path: str,
        *,
        with_time: bool = False,
        max_entries: int = MAX_ENTRIES,
        timeout: float | None = None,
    ) -> None:
        super().__init__(f"listing {path} on", path, timeout=timeout)
        self._max_entries = max_entries
        self._opcode = Opcode.LISTDIRECTORYWITHTIME if with_time else Opcode.LISTDIRECTORY

    def steps(self) -> Generator[Operation[Any], Any, tuple[Entry, ...]]:
        found: list[Entry] = []
        index = 0
        while True:
            try:
                reply = yield self.exchange(self._opcode, self._path, offset=index)
            except FileDenied as error:
                if error.code == FtpError.UNKNOWNCOMMAND and self._opcode != Opcode.LISTDIRECTORY:
                    self._opcode = Opcode.LISTDIRECTORY
                    continue
                # PX4 may send the errno of an earlier failure in place of EOF
                if error.code == FtpError.EOF or (index and error.code == FtpError.FILEEXISTS):
                    break
                raise
            entries, count = read_entries(reply.data)
            if not count:
                break
            found += entries
            index += count
            if index > self._max_entries:
                answer = f"the directory has more than the {self._max_entries} entries allowed"
                raise self.protocol_error(answer, limit="max_entries")
            self.report_progress(self.now, index)
        return tuple(found)


class PathOperation(_FtpProcedure[FtpPayload]):
    """An operation of one request with a path."""

    def __init__(
        self,
        description: str,
        opcode: int,
        path: str,
        *,
        offset: int = 0,
        other: str | None = None,
        timeout: float | None = None,
    ) -> None:
        super().__init__(description, path, timeout=timeout)
        self.modifies = opcode != Opcode.CALCFILECRC
        self._opcode, self._offset = opcode, offset
        if other is not None:
            self._path += b"\0" + path_bytes(other)
        if len(self._path) > MAX_DATA:
            raise InvalidArgumentError(f"both paths together must have at most {MAX_DATA - 1} bytes")
        # raises here, not later, if the request cannot be sent
        FtpPayload.request(opcode, self._path, offset=offset)

    def steps(self) -> Generator[Operation[Any], Any, FtpPayload]:
        reply: FtpPayload = yield self.exchange(self._opcode, self._path, offset=self._offset)
        return reply


class ComputeChecksum(PathOperation):
    """The checksum of a file, computed by the server."""

    def __init__(self, path: str, *, timeout: float | None = None) -> None:
        super().__init__(f"computing the checksum of {path} on", Opcode.CALCFILECRC, path, timeout=timeout)

    @property
    def crc(self) -> int:
        """The checksum, after the operation has succeeded."""
        return int.from_bytes(self.result().data[:4], "little")


class EndSession(Exchange):
    """The end of one session, or of all sessions of this client, open or not."""

    exclusive = True

    def __init__(self, session: int | None, server: ServerState) -> None:
        opcode = Opcode.RESETSESSION if session is None else Opcode.TERMINATESESSION
        super().__init__(
            "closing an FTP session of", FtpPayload.request(opcode, session=session or 0), server, timeout=8.0
        )

    def time_out(self, now: float, answer: str = "no answer") -> None:
        super().time_out(now, answer)
        logger.warning("%s", self.error)  # logged, because no caller receives the error


class FtpSessionClient(Client):
    """The base of `FtpClient`: the sessions, and the queue of operations."""

    handles = message_ids(common.FileTransferProtocol)

    def __init__(self, local: Address, target: Address) -> None:
        super().__init__(local, target)
        self.server = ServerState()
        self._sessions = 0

    @property
    def is_releasing(self) -> bool:
        return any(isinstance(operation, EndSession) for operation in (*self._running, *self._waiting))

    def new_session(self) -> int:
        """Return the number of the next session; unique, so that late packets of another do no harm."""
        self._sessions = self._sessions % LAST_SESSION + 1
        return self._sessions

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        if new.parent is not None or running.parent is not None:
            return False
        modifies = getattr(new, "modifies", False) or getattr(running, "modifies", False)
        return modifies or (getattr(new, "exclusive", False) and getattr(running, "exclusive", False))

    def end_session(self, session: int | None, now: float) -> EndSession:
        """Close a session before all queued operations; None: all, if its number is unknown."""
        operation = EndSession(session, self.server)
        operation.attach(self, now)
        self._waiting.appendleft(operation)
        return operation
