"""Files of another component: what can be asked for.

    open ── session ──► transfer ──► session ended ──► checksums compared ──► result

A server may have one session for everybody (PX4), so operations that open one queue behind each other, and
whatever ends one, an error and a cancellation too, ends the session: by TERMINATESESSION, or by RESETSESSIONS
if its number never became known or more than one may have been opened. `NOSESSIONSAVAILABLE` usually tells
of a session that an earlier run left open; it is reset once.

What changes something runs alone: a server remembers one reply, and another request between a lost
acknowledgement and its repetition would make it carry the request out twice.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.dialects import common
from mavstack.errors import FieldRangeError, FileDenied, FileTimeout, RemoteError, RemoteProtocolError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.ftp.entries import Entry, read_entries
from mavstack.services.ftp.exchange import Exchange, Peer
from mavstack.services.ftp.payload import (
    ALL_ONES,
    MOST_DATA,
    FtpError,
    FtpPayload,
    Opcode,
    file_crc32,
    path_bytes,
)
from mavstack.services.ftp.reading import ReadTransfer
from mavstack.services.ftp.writing import WriteTransfer
from mavstack.services.operation import Client, Operation, Procedure

if TYPE_CHECKING:
    from collections.abc import Generator

Result = TypeVar("Result")

#: More than this is not read into memory unless the caller raises it.
MOST_BYTES = 1 << 30
MOST_ENTRIES = 100_000
LAST_SESSION = 255


class _Asked(Procedure[Result]):
    """A procedure of this service."""

    timeout_error = FileTimeout
    exclusive = False
    modifies = False

    def __init__(self, description: str, path: str, *, timeout: float | None = None) -> None:
        super().__init__(description, timeout=timeout)
        self.path = path
        self._path = path_bytes(path)

    @property
    def ftp(self) -> FtpClient:
        """The client that runs it."""
        if not isinstance(self.client, FtpClient):
            raise FieldRangeError(f"{self.description} belongs to an FtpClient")
        return self.client

    def ask(self, opcode: int, data: bytes = b"", *, session: int = 0, offset: int = 0) -> Exchange:
        """One exchange as a step."""
        payload = FtpPayload.request(opcode, data, session=session, offset=offset)
        return Exchange(self.description, payload, self.ftp.peer)

    def remote_crc(self) -> Generator[Operation[Any], Any, int | None]:
        """The checksum that the server makes of the file; None if it does not."""
        if self.ftp.peer.no_crc:
            return None
        try:
            reply = yield self.ask(Opcode.CALCFILECRC, self._path)
        except RemoteError as error:
            self.ftp.peer.no_crc = isinstance(error, FileDenied) and error.code == FtpError.UNKNOWNCOMMAND
            return None
        return int.from_bytes(reply.data[:4], "little") if reply.size >= 4 else None

    def contradicted(self, answer: str) -> RemoteProtocolError:
        """The error of a file that is not what was transferred."""
        return RemoteProtocolError(self.description, str(self.target), answer=answer)


class _InSession(_Asked[Result]):
    """A procedure that opens a session."""

    exclusive = True
    _session: int | None = None
    _unclear = False  # whether there may be a session whose number is not known

    def open(self, opcode: int) -> Generator[Operation[Any], Any, FtpPayload]:
        """Open the file; clears away once what an earlier run left open."""
        try:
            reply = yield from self._open_once(opcode)
        except FileDenied as error:
            if error.code != FtpError.NOSESSIONSAVAILABLE:
                raise
            yield self.ask(Opcode.RESETSESSION)
            reply = yield from self._open_once(opcode)
        return reply

    def end_session(self) -> None:
        """Let the client end it, however often that must be said; nothing waits for it but the next one."""
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
        opening = self.ask(opcode, self._path, session=self.ftp.new_session())
        try:
            reply: FtpPayload = yield opening
        except FileDenied:
            self._unclear = opening.attempts > 1
            raise
        self._session, self._unclear = reply.session, opening.attempts > 1
        return reply


class ReadOperation(_InSession[bytes]):
    """Reads a file or a range of it; see `FtpClient.read_file`."""

    def __init__(
        self,
        path: str,
        *,
        offset: int = 0,
        size: int | None = None,
        verify: bool | None = None,
        most: int = MOST_BYTES,
        timeout: float | None = None,
    ) -> None:
        super().__init__(f"downloading {path} from", path, timeout=timeout)
        if offset < 0 or (size is not None and size < 0):
            raise FieldRangeError(f"there are no {size} bytes at {offset}")
        self.transfer: ReadTransfer | None = None
        self.verified = False
        self._range = (offset, size)
        self._most = most
        whole = offset == 0 and size is None
        self._verify = (whole and not path.startswith("@")) if verify is None else (verify and whole)

    def steps(self) -> Generator[Operation[Any], Any, bytes]:
        try:
            reply = yield from self.open(Opcode.OPENFILERO)
            announced = int.from_bytes(reply.data[:4], "little") if reply.size >= 4 else ALL_ONES
            start, end = self._bounds(announced)
            self.transfer = transfer = ReadTransfer(
                self.description, reply.session, start, end, self.ftp.peer
            )
            data: bytes = yield transfer
        finally:
            self.end_session()
        if self._verify:
            yield from self._compare(data)
        if len(data) < end - start and not self.verified and reply.size >= 4 and self.path[:1] != "@":
            raise self.contradicted("the file is shorter than announced")
        return data

    def child_ended(self, child: Operation[Any], now: float) -> None:
        if child is self.transfer:
            self.report_progress(now)
        super().child_ended(child, now)

    def _bounds(self, announced: int) -> tuple[int, int]:
        offset, size = self._range
        end = announced if size is None else min(offset + size, announced)
        if end - offset > self._most and announced != ALL_ONES:
            raise self.contradicted(f"{end - offset} bytes are more than the {self._most} allowed")
        return offset, max(end, offset)

    def _compare(self, data: bytes) -> Generator[Operation[Any], Any, None]:
        crc = yield from self.remote_crc()
        self.verified = crc is not None
        if crc is not None and crc != file_crc32(data):
            raise self.contradicted("the file's checksum is another: it changed while it was read")


class WriteOperation(_InSession[None]):
    """Creates or replaces a file; see `FtpClient.write_file`."""

    modifies = True

    def __init__(self, path: str, data: bytes, *, verify: bool = True, timeout: float | None = None) -> None:
        super().__init__(f"uploading {path} to", path, timeout=timeout)
        if len(data) > ALL_ONES:
            raise FieldRangeError("a file has at most 4 GiB")
        self.verified = False
        self._data = bytes(data)
        self._verify = verify

    def steps(self) -> Generator[Operation[Any], Any, None]:
        try:
            reply = yield from self.open(Opcode.CREATEFILE)
            yield WriteTransfer(self.description, reply.session, self._data, self.ftp.peer)
            yield from self._close(reply.session)
        finally:
            self.end_session()
        crc = (yield from self.remote_crc()) if self._verify else None
        self.verified = crc is not None
        if crc is not None and crc != file_crc32(self._data):
            raise self.contradicted("the file there has another checksum than what was written")

    def _close(self, session: int) -> Generator[Operation[Any], Any, None]:
        """Close the file, so that what was written is there before it is checked."""
        try:
            yield self.ask(Opcode.TERMINATESESSION, session=session)
        except FileDenied as error:
            if error.code != FtpError.INVALIDSESSION:
                raise
        self._session = None


class ListOperation(_Asked[tuple[Entry, ...]]):
    """Lists a directory; see `FtpClient.list_directory`."""

    def __init__(self, path: str, *, with_time: bool = False, timeout: float | None = None) -> None:
        super().__init__(f"listing {path} on", path, timeout=timeout)
        self._opcode = Opcode.LISTDIRECTORYWITHTIME if with_time else Opcode.LISTDIRECTORY

    def steps(self) -> Generator[Operation[Any], Any, tuple[Entry, ...]]:
        found: list[Entry] = []
        index = 0
        while index < MOST_ENTRIES:
            try:
                reply = yield self.ask(self._opcode, self._path, offset=index)
            except FileDenied as error:
                if error.code == FtpError.UNKNOWNCOMMAND and self._opcode != Opcode.LISTDIRECTORY:
                    self._opcode = Opcode.LISTDIRECTORY
                    continue
                # PX4 may tell the errno of an earlier failure in place of the end
                if error.code == FtpError.EOF or (index and error.code == FtpError.FILEEXISTS):
                    break
                raise
            entries, count = read_entries(reply.data)
            if not count:
                break
            found += entries
            index += count
        return tuple(found)


class PathOperation(_Asked[FtpPayload]):
    """One request about a path."""

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
        if len(self._path) > MOST_DATA:
            raise FieldRangeError(f"both paths together have at most {MOST_DATA - 1} bytes")
        FtpPayload.request(opcode, self._path, offset=offset)  # what cannot be sent is said at once

    def steps(self) -> Generator[Operation[Any], Any, FtpPayload]:
        reply: FtpPayload = yield self.ask(self._opcode, self._path, offset=self._offset)
        return reply


class ChecksumOperation(PathOperation):
    """Asks for a file's checksum, which is `crc`."""

    def __init__(self, path: str, *, timeout: float | None = None) -> None:
        super().__init__(f"computing the checksum of {path} on", Opcode.CALCFILECRC, path, timeout=timeout)

    @property
    def crc(self) -> int:
        """The checksum, once it has ended well."""
        return int.from_bytes(self.result().data[:4], "little")


class EndSession(Exchange):
    """Ends one session, or all of ours; that it was not open is fine."""

    exclusive = True

    def __init__(self, session: int | None, peer: Peer) -> None:
        opcode = Opcode.RESETSESSION if session is None else Opcode.TERMINATESESSION
        super().__init__(
            "closing an FTP session of", FtpPayload.request(opcode, session=session or 0), peer, timeout=8.0
        )


class FtpClient(Client):
    """Reads and changes the files of one component."""

    handles = message_ids(common.FileTransferProtocol)

    def __init__(self, local: Address, target: Address) -> None:
        super().__init__(local, target)
        self.peer = Peer()
        self._sessions = 0

    def new_session(self) -> int:
        """What to call the next session; its own, so that late packets of another do not touch its file."""
        self._sessions = self._sessions % LAST_SESSION + 1
        return self._sessions

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        if new.parent is not None or running.parent is not None:
            return False
        modifies = getattr(new, "modifies", False) or getattr(running, "modifies", False)
        return modifies or (getattr(new, "exclusive", False) and getattr(running, "exclusive", False))

    def read_file(
        self,
        path: str,
        now: float,
        *,
        offset: int = 0,
        size: int | None = None,
        verify: bool | None = None,
        most: int = MOST_BYTES,
        timeout: float | None = None,
    ) -> ReadOperation:
        """Read a file, or `size` bytes of it; a whole one is compared by checksum, if the server makes one.

        A virtual file (its path begins with @) is compared only if `verify` says so: it is made anew.
        """
        operation = ReadOperation(path, offset=offset, size=size, verify=verify, most=most, timeout=timeout)
        return self.begin(operation, now)

    def write_file(
        self, path: str, data: bytes, now: float, *, verify: bool = True, timeout: float | None = None
    ) -> WriteOperation:
        """Create a file, or replace what it holds."""
        return self.begin(WriteOperation(path, data, verify=verify, timeout=timeout), now)

    def list_directory(
        self, path: str, now: float, *, with_time: bool = False, timeout: float | None = None
    ) -> ListOperation:
        """The entries of a directory, with the times of change if the server knows that."""
        return self.begin(ListOperation(path, with_time=with_time, timeout=timeout), now)

    def crc(self, path: str, now: float, *, timeout: float | None = None) -> ChecksumOperation:
        """The checksum of a file; it is the operation's `crc`."""
        return self.begin(ChecksumOperation(path, timeout=timeout), now)

    def remove(self, path: str, now: float, *, timeout: float | None = None) -> PathOperation:
        """Remove a file."""
        return self._ask(f"removing {path} on", Opcode.REMOVEFILE, path, now, timeout=timeout)

    def rename(self, path: str, to: str, now: float, *, timeout: float | None = None) -> PathOperation:
        """Rename or move a file or directory."""
        return self._ask(f"renaming {path} to {to} on", Opcode.RENAME, path, now, other=to, timeout=timeout)

    def truncate(self, path: str, size: int, now: float, *, timeout: float | None = None) -> PathOperation:
        """Make a file that long."""
        return self._ask(
            f"truncating {path} on", Opcode.TRUNCATEFILE, path, now, offset=size, timeout=timeout
        )

    def make_directory(self, path: str, now: float, *, timeout: float | None = None) -> PathOperation:
        """Make a directory."""
        return self._ask(f"making directory {path} on", Opcode.CREATEDIRECTORY, path, now, timeout=timeout)

    def remove_directory(self, path: str, now: float, *, timeout: float | None = None) -> PathOperation:
        """Remove an empty directory."""
        return self._ask(f"removing directory {path} on", Opcode.REMOVEDIRECTORY, path, now, timeout=timeout)

    def reset_sessions(self, now: float) -> EndSession:
        """Close all sessions, where the server has but one for all those of others too."""
        return self.begin(EndSession(None, self.peer), now)

    def end_session(self, session: int | None, now: float) -> EndSession:
        """End a session before anything else that waits; None: all of ours, if its number is not known."""
        operation = EndSession(session, self.peer)
        operation.attach(self, now)
        self._waiting.appendleft(operation)
        return operation

    def _ask(
        self,
        description: str,
        opcode: int,
        path: str,
        now: float,
        *,
        offset: int = 0,
        other: str | None = None,
        timeout: float | None = None,
    ) -> PathOperation:
        return self.begin(
            PathOperation(description, opcode, path, offset=offset, other=other, timeout=timeout), now
        )
