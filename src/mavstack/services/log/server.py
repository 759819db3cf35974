"""The log server.

Each client has at most one outstanding list and one range of data; a new request replaces it, as in PX4. All
clients are served in turn while the links to them have room. A range up to the end of a log ends with a chunk
that is not full, if necessary an empty one. A request for a missing or unreadable log is not answered.
"""

from __future__ import annotations

from collections import OrderedDict, deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.log.entry import CHUNK, LAST_ID, MAX_UINT32, LogEntry
from mavstack.services.service import Event, HasRoom, Outgoing, Priority, Service, always_room
from mavstack.services.timing import DUPLICATE_WINDOW

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.dialects import Message
    from mavstack.wire import Packet

MAX_CLIENTS = 32


class LogStore(Protocol):
    """The storage of logs. `read` and `erase` may raise OSError."""

    def logs(self) -> Sequence[LogEntry]:
        """Return all logs by ascending id."""

    def read(self, number: int, offset: int, count: int, /) -> bytes:
        """Read bytes of a log; fewer at its end."""

    def erase(self) -> None:
        """Remove all logs."""


@dataclass(frozen=True, slots=True)
class LogsErased(Event):
    """A client erased all logs."""

    source: Address


@dataclass(slots=True)
class _Session:
    """The outstanding requests of one client."""

    entries: deque[common.LogEntry] = field(default_factory=deque)
    log: int = 0
    offset: int = 0
    end: int = 0
    size: int = 0
    sending: bool = False


class LogServer(Service):
    """The server of a component's logs; it ignores requests while `available` returns False, as in flight."""

    handles = message_ids(common.LogRequestList, common.LogRequestData, common.LogRequestEnd, common.LogErase)

    def __init__(
        self, local: Address, store: LogStore, *, available: Callable[[], bool] = lambda: True
    ) -> None:
        super().__init__(local)
        self._store = store
        self._available = available
        self._sessions: OrderedDict[Address, _Session] = OrderedDict()
        self._last_erase: tuple[bytes, float] | None = None

    def receive(self, packet: Packet, now: float) -> None:
        source = Address(packet.system, packet.component)
        if isinstance(packet.message, common.LogRequestEnd):
            self._sessions.pop(source, None)
        elif self._available():
            match packet.message:
                case common.LogRequestList(start=first, end=last):
                    self._list(source, first, last)
                case common.LogRequestData(id=number, ofs=offset, count=count):
                    self._send_data(source, number, offset, count)
                case common.LogErase():
                    self._erase(source, packet.raw, now)

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        waiting = deque(self._sessions)
        while waiting:
            source = waiting.popleft()
            session = self._sessions.get(source)
            if session is None or not has_room(source):
                continue
            message = self._next_message(session)
            if message is None:
                del self._sessions[source]
                continue
            waiting.append(source)
            yield Outgoing(message, source, Priority.BULK)

    def _session(self, source: Address) -> _Session:
        session = self._sessions.setdefault(source, _Session())
        self._sessions.move_to_end(source)
        if len(self._sessions) > MAX_CLIENTS:
            self._sessions.popitem(last=False)
        return session

    def _list(self, source: Address, first: int, last: int) -> None:
        logs = [log for log in self._store.logs() if 0 <= log.id <= LAST_ID]
        session = self._session(source)
        if not logs:
            session.entries = deque([common.LogEntry()])
            return
        highest = max(log.id for log in logs)
        session.entries = deque(
            common.LogEntry(
                id=log.id,
                num_logs=len(logs),
                last_log_num=highest,
                time_utc=min(max(log.time_utc, 0), MAX_UINT32),
                size=min(max(log.size, 0), MAX_UINT32),
            )
            for log in logs
            if first <= log.id <= last
        )

    def _send_data(self, source: Address, number: int, offset: int, count: int) -> None:
        log = next((log for log in self._store.logs() if log.id == number), None)
        if log is not None and count > 0:
            session = self._session(source)
            session.log, session.size, session.sending = number, log.size, True
            session.offset, session.end = offset, offset + count

    def _erase(self, source: Address, raw: bytes, now: float) -> None:
        last, self._last_erase = self._last_erase, (raw, now)
        if last is not None and last[0] == raw and now - last[1] < DUPLICATE_WINDOW:
            return
        self._sessions.clear()
        try:
            self._store.erase()
        except OSError:
            return
        self.emit(LogsErased(source))

    def _next_message(self, session: _Session) -> Message | None:
        if session.entries:
            return session.entries.popleft()
        return self._next_data(session) if session.sending else None

    def _next_data(self, session: _Session) -> common.LogData | None:
        offset = session.offset
        wanted = max(min(CHUNK, session.end - offset, session.size - offset), 0)
        try:
            content = self._store.read(session.log, offset, wanted)[:wanted] if wanted else b""
        except OSError:
            session.sending = False
            return None
        session.offset += len(content)
        session.sending = len(content) == CHUNK and session.offset < session.end
        return common.LogData(id=session.log, ofs=offset, count=len(content), data=content)
