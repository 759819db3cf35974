"""The FTP server (guide: file transfer protocol).

Each request is executed at once and answered once; a repeated request (same number and content) gets the same
reply and is not executed again. A burst is made packet by packet while the links to the client have room, up
to a limit, so that a client that has left costs little; its last packet has `burst_complete` set. With
`paced=False` the burst is sent at once, as by a server that does not know the links behind it.
"""

from __future__ import annotations

from collections.abc import Callable
from errno import EEXIST, ENOENT, ENOTDIR
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.ftp.entries import pack_entries
from mavstack.services.ftp.payload import MAX_DATA, SEQUENCES, FtpError, FtpPayload, Opcode, file_crc32
from mavstack.services.ftp.sessions import Burst, ReplyCache, Session, Sessions
from mavstack.services.service import HasRoom, Outgoing, Priority, Service

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.ftp.stores import FileStore
    from mavstack.wire import Packet

#: Seconds: mavftp gives up 3.7 s after its last request, whatever it receives.
MAX_BURST_DURATION = 3.0
#: A burst ends after this number of bytes or packets; the client requests the next one.
MAX_BURST_BYTES, MAX_BURST_PACKETS = 150 * MAX_DATA, 500
_CRC_PIECE = 1 << 16
_MODIFYING = frozenset(
    {
        Opcode.CREATEFILE,
        Opcode.OPENFILEWO,
        Opcode.WRITEFILE,
        Opcode.REMOVEFILE,
        Opcode.CREATEDIRECTORY,
        Opcode.REMOVEDIRECTORY,
        Opcode.TRUNCATEFILE,
        Opcode.RENAME,
    }
)


#: The handler of an opcode: takes the request, its source and the time, returns the reply.
_Handler: TypeAlias = Callable[[FtpPayload, Address, float], FtpPayload]


class _RefusedError(Exception):
    """The request is answered by a NAK."""

    def __init__(self, code: int) -> None:
        super().__init__(code)
        self.code = code


class FtpServer(Service):
    """The FTP server of one component.

    Args:
        local: The local component.
        store: The files.
        read_only: Refuse all modifying requests.
        paced: Send bursts only as fast as the links to the client have room.
    """

    handles = message_ids(common.FileTransferProtocol)

    def __init__(
        self, local: Address, store: FileStore, *, read_only: bool = False, paced: bool = True
    ) -> None:
        super().__init__(local)
        self.store = store
        self.read_only = read_only
        self.sessions = Sessions()
        self._paced = paced
        self._replies = ReplyCache()
        self._handlers: dict[int, _Handler] = {
            Opcode.NONE: self._nothing,
            Opcode.TERMINATESESSION: self._terminate,
            Opcode.RESETSESSION: self._reset,
            Opcode.LISTDIRECTORY: self._list,
            Opcode.LISTDIRECTORYWITHTIME: self._list,
            Opcode.OPENFILERO: self._open,
            Opcode.OPENFILEWO: self._open,
            Opcode.CREATEFILE: self._open,
            Opcode.READFILE: self._read,
            Opcode.WRITEFILE: self._write,
            Opcode.REMOVEFILE: self._change_path,
            Opcode.CREATEDIRECTORY: self._change_path,
            Opcode.REMOVEDIRECTORY: self._change_path,
            Opcode.TRUNCATEFILE: self._truncate,
            Opcode.RENAME: self._rename,
            Opcode.CALCFILECRC: self._crc,
        }

    def receive(self, packet: Packet, now: float) -> None:
        request = None if packet.message is None else FtpPayload.read(packet.message)
        if request is None or request.opcode in (Opcode.ACK, Opcode.NAK):
            return
        source = Address(packet.system, packet.component)
        known = self._replies.find(source, request, now)
        if known is not None:
            self.send(known, source)
            return
        reply = self._execute(request, source, now)
        if reply is not None:
            self._answer(request, reply, source, now)

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        bursting = [session for session in self.sessions if session.burst is not None]
        while bursting:
            for session in tuple(bursting):
                burst = session.burst
                if burst is None or (self._paced and not has_room(session.owner)):
                    bursting.remove(session)
                    continue
                session.used_at = now
                reply = self._next_burst_reply(session, burst, now)
                yield Outgoing(reply.to_message(*session.owner), session.owner, Priority.BULK)

    def next_timeout(self) -> float | None:
        return self.sessions.next_timeout()

    def handle_timeout(self, now: float) -> None:
        self.sessions.close_idle(now)

    # Replies

    def _execute(self, request: FtpPayload, source: Address, now: float) -> FtpPayload | None:
        try:
            if request.size > MAX_DATA and request.opcode not in (Opcode.READFILE, Opcode.BURSTREADFILE):
                raise _RefusedError(FtpError.INVALIDDATASIZE)
            if self.read_only and request.opcode in _MODIFYING:
                raise _RefusedError(FtpError.FILEPROTECTED)
            if request.opcode == Opcode.BURSTREADFILE:
                self._begin_burst(request, source, now)
                return None
            handler = self._handlers.get(request.opcode)
            if handler is None:
                raise _RefusedError(FtpError.UNKNOWNCOMMAND)
            return handler(request, source, now)
        except _RefusedError as refused:
            return _nak(request, refused.code)
        except OSError as error:
            return _nak(request, *_code_of(error))
        except ValueError:  # a path with characters that the file system does not allow
            return _nak(request, FtpError.FAIL)

    def _answer(self, request: FtpPayload, reply: FtpPayload, source: Address, now: float) -> None:
        if request.opcode in (Opcode.TERMINATESESSION, Opcode.RESETSESSION):
            self._replies.expire_soon(source, now)
        message = reply.to_message(*source)
        long = request.opcode in _MODIFYING or request.opcode == Opcode.OPENFILERO
        self._replies.add(source, request, message, now, long=long)
        self.send(message, source)

    # Handlers

    def _nothing(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        return _ack(request)

    def _terminate(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        self.sessions.close(self._session(request, source, now))
        return _ack(request)

    def _reset(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        for session in self.sessions:
            if session.owner == source:
                self.sessions.drop(session)
        return _ack(request)

    def _list(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        entries = self.store.list_directory(_path(request.data))
        if request.offset >= len(entries):
            raise _RefusedError(FtpError.EOF)
        with_time = request.opcode == Opcode.LISTDIRECTORYWITHTIME
        return _ack(request, pack_entries(entries, request.offset, with_time=with_time))

    def _open(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        path = _path(request.data)
        if not self.sessions.make_room(source, request.session, now):
            raise _RefusedError(FtpError.NOSESSIONSAVAILABLE)
        writable = request.opcode != Opcode.OPENFILERO
        file = self.store.open_file(path, write=writable, truncate=request.opcode == Opcode.CREATEFILE)
        self.sessions.add(source, request.session, file, now, writable=writable)
        size = min(file.size(), 0xFFFFFFFF)
        return _ack(request, size.to_bytes(4, "little"))

    def _read(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        session = self._session(request, source, now)
        data = session.file.read(request.offset, min(request.size, MAX_DATA))
        if not data and request.size:
            raise _RefusedError(FtpError.EOF)
        return _ack(request, data)

    def _write(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        session = self._session(request, source, now)
        if not session.writable:
            raise _RefusedError(FtpError.FILEPROTECTED)
        session.file.write(request.offset, request.data)
        return _ack(request, len(request.data).to_bytes(4, "little"))

    def _change_path(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        change = {
            Opcode.REMOVEFILE: self.store.remove,
            Opcode.CREATEDIRECTORY: self.store.make_directory,
            Opcode.REMOVEDIRECTORY: self.store.remove_directory,
        }[Opcode(request.opcode)]
        change(_path(request.data))
        return _ack(request)

    def _truncate(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        self.store.truncate(_path(request.data), request.offset)
        return _ack(request)

    def _rename(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        one, found, other = request.data.partition(b"\0")
        if not found:
            raise _RefusedError(FtpError.INVALIDDATASIZE)
        self.store.rename(_path(one), _path(other))
        return _ack(request)

    def _crc(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        file = self.store.open_file(_path(request.data))
        crc = offset = 0
        try:
            while piece := file.read(offset, _CRC_PIECE):
                crc, offset = file_crc32(piece, crc), offset + len(piece)
        finally:
            file.close()
        return _ack(request, crc.to_bytes(4, "little"))

    def _session(self, request: FtpPayload, source: Address, now: float) -> Session:
        session = self.sessions.find(request.session, source)
        if session is None:
            raise _RefusedError(FtpError.INVALIDSESSION)
        session.used_at = now
        return session

    # BurstTracker

    def _begin_burst(self, request: FtpPayload, source: Address, now: float) -> None:
        session = self._session(request, source, now)
        size = min(request.size or MAX_DATA, MAX_DATA)
        session.burst = Burst(request.sequence, request.offset, size, now + MAX_BURST_DURATION)

    def _next_burst_reply(self, session: Session, burst: Burst, now: float) -> FtpPayload:
        burst.packets += 1
        reply = FtpPayload(
            (burst.sequence + burst.packets) % SEQUENCES,
            Opcode.ACK,
            session.number,
            req_opcode=Opcode.BURSTREADFILE,
            offset=burst.offset,
        )
        try:
            data = session.file.read(burst.offset, burst.size)
        except OSError as error:
            session.burst = None
            return _nak(reply, *_code_of(error), of_burst=True)
        if not data:
            session.burst = None
            return _nak(reply, FtpError.EOF, of_burst=True)
        burst.offset += len(data)
        sent = burst.packets * burst.size
        complete = burst.packets >= MAX_BURST_PACKETS or sent >= MAX_BURST_BYTES or now >= burst.ends_at
        if complete:
            session.burst = None
        return FtpPayload(
            reply.sequence,
            Opcode.ACK,
            session.number,
            len(data),
            Opcode.BURSTREADFILE,
            complete,
            reply.offset,
            data,
        )


def _ack(request: FtpPayload, data: bytes = b"") -> FtpPayload:
    return FtpPayload(
        (request.sequence + 1) % SEQUENCES,
        Opcode.ACK,
        request.session,
        len(data),
        request.opcode,
        offset=request.offset,
        data=data,
    )


def _nak(request: FtpPayload, code: int, errno: int | None = None, *, of_burst: bool = False) -> FtpPayload:
    data = bytes([code]) if errno is None else bytes([code, errno & 0xFF])
    return FtpPayload(
        request.sequence if of_burst else (request.sequence + 1) % SEQUENCES,
        Opcode.NAK,
        request.session,
        len(data),
        request.req_opcode if of_burst else request.opcode,
        of_burst,
        request.offset,
        data,
    )


def _code_of(error: OSError) -> tuple[int, int | None]:
    if isinstance(error, FileNotFoundError) or error.errno in (ENOENT, ENOTDIR):
        return FtpError.FILENOTFOUND, None
    if isinstance(error, FileExistsError) or error.errno == EEXIST:
        return FtpError.FILEEXISTS, None
    if isinstance(error, PermissionError):
        return FtpError.FILEPROTECTED, None
    return FtpError.FAILERRNO, error.errno or 0


def _path(data: bytes) -> str:
    """Decode a path; some clients include its NUL."""
    path = data.removesuffix(b"\0")
    if not path or b"\0" in path:
        raise _RefusedError(FtpError.INVALIDDATASIZE)
    return path.decode("utf-8", "surrogateescape")
