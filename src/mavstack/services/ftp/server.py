"""The FTP server (guide: file transfer protocol).

Each request is answered once; a repeated request (same number and content) gets the same reply and is not
executed again. Requests that take long wait in a queue (see `work_queue`); all others are executed at once. A
burst is made packet by packet while the links to the client have room, up
to a limit, so that a client that has left costs little; its last packet has `burst_complete` set. With
`paced=False` the burst is sent at once, as by a server that does not know the links behind it.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.ftp.entries import pack_entries
from mavstack.services.ftp.payload import MAX_DATA, SEQUENCES, FtpError, FtpPayload, Opcode, file_crc32
from mavstack.services.ftp.replies import RefusedError, ack, error_code, nak, read_path
from mavstack.services.ftp.sessions import Burst, ReplyCache, Session, Sessions
from mavstack.services.ftp.work_queue import Steps, Work, WorkQueue
from mavstack.services.service import HasRoom, Outgoing, Priority, Service, earliest

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.services.ftp.entries import Entry
    from mavstack.services.ftp.stores import FileStore
    from mavstack.wire import Packet

#: The longest burst in seconds: mavftp gives up 3.7 s after its last request, even if packets arrive.
MAX_BURST_DURATION = 3.0
#: A burst ends after this number of bytes or packets; the client requests the next one.
MAX_BURST_BYTES, MAX_BURST_PACKETS = 150 * MAX_DATA, 500
#: The number of bytes of a checksum that are computed in one slice.
CRC_SLICE = 1 << 18
#: The number of burst packets that are sent in one slice.
MAX_PACKETS_AT_ONCE = 100
#: The largest number of listings kept while clients request their pages, and the seconds for which a listing
#: is kept after its last page.
MAX_LISTINGS, LISTING_LIFETIME = 4, 5.0
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


#: The opcodes of requests that wait in the work queue.
_QUEUED = frozenset(
    {
        Opcode.LISTDIRECTORY,
        Opcode.LISTDIRECTORYWITHTIME,
        Opcode.OPENFILERO,
        Opcode.OPENFILEWO,
        Opcode.CREATEFILE,
        Opcode.CALCFILECRC,
        Opcode.REMOVEFILE,
        Opcode.CREATEDIRECTORY,
        Opcode.REMOVEDIRECTORY,
        Opcode.TRUNCATEFILE,
        Opcode.RENAME,
    }
)

#: The handler of an opcode: takes the request, its source and the time, returns the reply.
_Handler: TypeAlias = Callable[[FtpPayload, Address, float], FtpPayload]


class FtpServer(Service):
    """The FTP server of one component.

    Args:
        local: The local component.
        store: The files.
        read_only: Refuse all modifying requests.
        paced: Send bursts only as fast as the links to the client have room.
        is_authenticated: Returns whether the packets of a client have valid signatures; its sessions come
            before those of others.
    """

    handles = message_ids(common.FileTransferProtocol)

    def __init__(
        self,
        local: Address,
        store: FileStore,
        *,
        read_only: bool = False,
        paced: bool = True,
        is_authenticated: Callable[[Address], bool] = lambda _: False,
    ) -> None:
        super().__init__(local)
        self.store = store
        self.read_only = read_only
        self.sessions = Sessions()
        self._paced = paced
        self._is_authenticated = is_authenticated
        self._replies = ReplyCache()
        self._work = WorkQueue()
        self._burst_due: float | None = None
        self._listings: OrderedDict[tuple[Address, str], _Listing] = OrderedDict()
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
        if request.opcode in _QUEUED:
            self._work.add(source, request)
            self._continue_work(now)
            return
        reply = self._execute(request, source, now)
        if reply is not None:
            self._answer(request, reply, source, now)

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        self._burst_due = None
        bursting = self.sessions.bursting()
        packets = 0
        while bursting:
            for session in tuple(bursting):
                burst = session.burst
                if burst is None or (self._paced and not has_room(session.owner)):
                    bursting.remove(session)
                    continue
                if packets >= MAX_PACKETS_AT_ONCE:
                    self._burst_due = now
                    return
                packets += 1
                session.used_at = now
                self.sessions.served(session)
                reply = self._next_burst_reply(session, burst, now)
                yield Outgoing(reply.to_message(*session.owner), session.owner, Priority.BULK)

    def next_timeout(self) -> float | None:
        return earliest(self.sessions.next_timeout(), self._work.next_timeout(), self._burst_due)

    def handle_timeout(self, now: float) -> None:
        self.sessions.close_idle(now)
        self._continue_work(now)

    # Replies

    def _continue_work(self, now: float) -> None:
        while (work := self._work.next(now)) is not None:
            ended = True  # stays True if the store raises an unexpected exception
            try:
                reply = self._execute(work.request, work.source, now, work)
                ended = reply is not None
            finally:
                self._work.stepped(work, now, ended=ended)
            if reply is not None:
                self._answer(work.request, reply, work.source, now)

    def _execute(
        self, request: FtpPayload, source: Address, now: float, work: Work | None = None
    ) -> FtpPayload | None:
        """Execute a request, or the next slice of `work`; returns the reply, None if there is none yet."""
        try:
            if request.size > MAX_DATA and request.opcode not in (Opcode.READFILE, Opcode.BURSTREADFILE):
                raise RefusedError(FtpError.INVALIDDATASIZE)
            if self.read_only and request.opcode in _MODIFYING:
                raise RefusedError(FtpError.FILEPROTECTED)
            if request.opcode == Opcode.BURSTREADFILE:
                self._begin_burst(request, source, now)
                return None
            if work is not None and request.opcode == Opcode.CALCFILECRC:
                return self._continue_crc(work)
            if request.opcode in _MODIFYING:
                self._listings.clear()
            handler = self._handlers.get(request.opcode)
            if handler is None:
                raise RefusedError(FtpError.UNKNOWNCOMMAND)
            return handler(request, source, now)
        except RefusedError as refused:
            return nak(request, refused.code)
        except OSError as error:
            return nak(request, *error_code(error))
        except ValueError:  # the path has characters that the file system does not allow
            return nak(request, FtpError.FAIL)

    def _answer(self, request: FtpPayload, reply: FtpPayload, source: Address, now: float) -> None:
        if request.opcode in (Opcode.TERMINATESESSION, Opcode.RESETSESSION):
            self._replies.expire_soon(source, now)
        message = reply.to_message(*source)
        long = request.opcode in _MODIFYING or request.opcode == Opcode.OPENFILERO
        self._replies.add(source, request, message, now, long=long)
        self.send(message, source)

    # Handlers

    def _nothing(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        return ack(request)

    def _terminate(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        self.sessions.close(self._session(request, source, now))
        return ack(request)

    def _reset(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        self._work.discard(source)
        for session in self.sessions:
            if session.owner == source:
                self.sessions.drop(session)
        return ack(request)

    def _list(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        entries = self._listing(read_path(request.data), request.offset, source, now)
        if request.offset >= len(entries):
            raise RefusedError(FtpError.EOF)
        with_time = request.opcode == Opcode.LISTDIRECTORYWITHTIME
        return ack(request, pack_entries(entries, request.offset, with_time=with_time))

    def _listing(self, path: str, index: int, source: Address, now: float) -> Sequence[Entry]:
        """Return the entries of a directory; the pages of one client are those of one listing."""
        known = self._listings.get((source, path))
        if not index or known is None or now > known.until:
            known = self._listings[source, path] = _Listing(self.store.list_directory(path))
            while len(self._listings) > MAX_LISTINGS:
                self._listings.popitem(last=False)
        known.until = now + LISTING_LIFETIME
        return known.entries

    def _open(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        path = read_path(request.data)
        authenticated = self._is_authenticated(source)
        if not self.sessions.make_room(source, request.session, now, authenticated=authenticated):
            raise RefusedError(FtpError.NOSESSIONSAVAILABLE)
        writable = request.opcode != Opcode.OPENFILERO
        file = self.store.open_file(path, write=writable, truncate=request.opcode == Opcode.CREATEFILE)
        self.sessions.add(source, request.session, file, now, writable=writable, authenticated=authenticated)
        size = min(file.size(), 0xFFFFFFFF)
        return ack(request, size.to_bytes(4, "little"))

    def _read(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        session = self._session(request, source, now)
        data = session.file.read(request.offset, min(request.size, MAX_DATA))
        if not data and request.size:
            raise RefusedError(FtpError.EOF)
        return ack(request, data)

    def _write(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        session = self._session(request, source, now)
        if not session.writable:
            raise RefusedError(FtpError.FILEPROTECTED)
        session.file.write(request.offset, request.data)
        return ack(request, len(request.data).to_bytes(4, "little"))

    def _change_path(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        change = {
            Opcode.REMOVEFILE: self.store.remove,
            Opcode.CREATEDIRECTORY: self.store.make_directory,
            Opcode.REMOVEDIRECTORY: self.store.remove_directory,
        }[Opcode(request.opcode)]
        change(read_path(request.data))
        return ack(request)

    def _truncate(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        self.store.truncate(read_path(request.data), request.offset)
        return ack(request)

    def _rename(self, request: FtpPayload, source: Address, now: float) -> FtpPayload:
        one, found, other = request.data.partition(b"\0")
        if not found:
            raise RefusedError(FtpError.INVALIDDATASIZE)
        self.store.rename(read_path(one), read_path(other))
        return ack(request)

    def _continue_crc(self, work: Work) -> FtpPayload | None:
        if work.steps is None:
            work.steps = self._crc(work.request)
        try:
            next(work.steps)
        except StopIteration as end:
            reply: FtpPayload = end.value
            return reply
        return None

    def _crc(self, request: FtpPayload) -> Steps:
        file = self.store.open_file(read_path(request.data))
        crc = offset = 0
        try:
            while piece := file.read(offset, CRC_SLICE):
                crc, offset = file_crc32(piece, crc), offset + len(piece)
                if len(piece) == CRC_SLICE:
                    yield
        finally:
            file.close()
        return ack(request, crc.to_bytes(4, "little"))

    def _session(self, request: FtpPayload, source: Address, now: float) -> Session:
        session = self.sessions.find(request.session, source)
        if session is None:
            raise RefusedError(FtpError.INVALIDSESSION)
        session.used_at = now
        return session

    # Bursts

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
            return nak(reply, *error_code(error), of_burst=True)
        if not data:
            session.burst = None
            return nak(reply, FtpError.EOF, of_burst=True)
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


@dataclass(slots=True)
class _Listing:
    """The entries of a directory, kept until a time."""

    entries: Sequence[Entry]
    until: float = 0.0
