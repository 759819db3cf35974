"""The connections of an HTTP server: bounded in number, with deadlines for requests that do not arrive.

A full server closes a connection for each new one (see `mavstack.security.admission`): first one whose
request has not arrived completely, then one that is unused between two requests or reads its answer slowly,
never one of a client with a session that may act. The application identifies clients by `mark_client`.

A request whose head has arrived waits for its turn (see `mavstack.http.request_lane`), except a request
that comes first. Until then its bytes cost neither the server nor the application any work.

A `Connection` is between the transport and the protocol of the server, whatever that is: it sees when bytes
arrive. Around the application, `Connections.tracking` sees requests and answers. A request finds its
connection by a context variable, since the server starts the application while the connection passes bytes.
"""

from __future__ import annotations

import asyncio
from collections import Counter, deque
from contextvars import ContextVar
from time import monotonic
from typing import TYPE_CHECKING, Final

from mavstack.http.bodies import has_body
from mavstack.http.early_answers import read_request
from mavstack.http.idle_timer import IdleTimer
from mavstack.http.request_lane import RequestLane, has_whole_head, read_head
from mavstack.security.admission import Admission, Place, Proof

if TYPE_CHECKING:
    from collections.abc import Callable

    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from mavstack.http.early_answers import EarlyAnswer
    from mavstack.http.request_lane import ComesFirst

#: The largest number of open connections, so that file descriptors remain for the links of the program.
MAX_CONNECTIONS: Final = 512
#: Seconds to receive the head of a request, and between two parts of its body.
HEAD_TIMEOUT: Final = 20.0
#: Seconds for which the order of silent connections is used again; a full server closes them in this order.
ORDER_LIFETIME: Final = 0.5
#: Seconds for which further connections of a refused address are refused without a comparison of all
#: connections.
REFUSAL_LIFETIME: Final = 0.02
_current: Final[ContextVar[Connection]] = ContextVar("mavstack_http_connection")


def mark_client(proof: Proof, holder: str) -> None:
    """Tell the server who the client of the present request is.

    Args:
        proof: The proof of the client; `AUTHENTICATED`: its connection is kept while it is in use.
        holder: The name under which its connections are counted with others; empty: its address.
    """
    connection = _current.get(None)
    if connection is not None:
        connection.proof = proof
        connection.holder = holder or connection.host


class Connections:
    """The connections of one server.

    Args:
        comes_first: Decides which requests wait for no others; None: all wait for their turn.
        answer_early: Answers requests by their heads alone; None: the application answers all.
    """

    def __init__(
        self, comes_first: ComesFirst | None = None, answer_early: EarlyAnswer | None = None
    ) -> None:
        self.lane = RequestLane()
        self.answer_early = answer_early
        self._comes_first = comes_first
        self._admission = Admission(MAX_CONNECTIONS, min_stay=0)
        self._open: set[Connection] = set()
        #: Silent connections in the order in which a full server closes them, as found for an earlier
        #: connection.
        self._next_leaving: deque[Connection] = deque()
        self._next_found_at = 0.0
        self._refused = ("", 0.0)

    def admit(self, connection: Connection) -> bool:
        """Take a connection, or refuse it; another one may be closed for it."""
        if len(self._open) >= MAX_CONNECTIONS and not self._make_room(connection.host):
            return False
        self._open.add(connection)
        return True

    def begin(self, head: bytearray, begin: Callable[[], None]) -> None:
        """Call a function when the request with some head may begin: at once, or in its turn."""
        if self._comes_first is not None and self._comes_first(read_head(head)):
            begin()
        else:
            self.lane.enter(begin)

    def _make_room(self, host: str) -> bool:
        """Return whether there is a place for a newcomer; another connection may be closed for it.

        The places of all connections are compared once for many newcomers of a burst.
        """
        now = monotonic()
        if self._refused[0] == host and now - self._refused[1] <= REFUSAL_LIFETIME:
            return False
        if now - self._next_found_at <= ORDER_LIFETIME:
            while self._next_leaving:
                leaving = self._next_leaving.popleft()
                if leaving in self._open and leaving.is_silent:
                    self._close(leaving)
                    return True
        # Connections that became WebSockets do not report their end.
        self._open = {each for each in self._open if not each.is_closing}
        places = [each.place() for each in self._open]
        admitted, chosen = self._admission.admit(host, places, now)
        if chosen is not None:
            self._close(chosen)
        if not admitted:
            self._refused = host, now
        self._find_next(places, chosen, now)
        return admitted

    def _find_next(self, places: list[Place[Connection]], chosen: Connection | None, now: float) -> None:
        self._next_found_at = now
        silent = [each for each in places if each.proof is Proof.SILENT and each.owner is not chosen]
        shares = Counter(each.holder for each in places)
        silent.sort(key=lambda each: (-shares[each.holder], each.used_at))
        largest = [each.owner for each in silent if shares[each.holder] == shares[silent[0].holder]]
        self._next_leaving = deque(largest[: MAX_CONNECTIONS // 8])

    def _close(self, connection: Connection) -> None:
        connection.abort()
        self._open.discard(connection)

    def remove(self, connection: Connection) -> None:
        """Remove a connection that is closed. Idempotent."""
        self._open.discard(connection)

    def tracking(self, app: ASGIApp) -> ASGIApp:
        """Return an application that reports its requests to their connections."""

        async def tracked(scope: Scope, receive: Receive, send: Send) -> None:
            connection = _current.get(None)
            if connection is None or scope["type"] not in ("http", "websocket"):
                await app(scope, receive, send)
            elif scope["type"] == "websocket":
                connection.begin_websocket()
                await app(scope, receive, send)
            else:
                await connection.answer(app, scope, receive, send)

        return tracked


class Connection(asyncio.Protocol):
    """One connection until it becomes a WebSocket.

    Args:
        protocol: The protocol of the server, which speaks HTTP.
        connections: All connections of the server.
    """

    def __init__(self, protocol: asyncio.Protocol, connections: Connections) -> None:
        self.host = ""
        self.holder = ""
        self.proof = Proof.SPEAKING
        self._protocol = protocol
        self._connections = connections
        self._transport: asyncio.Transport | None = None
        self._deadline: asyncio.TimerHandle | None = None
        self._idle = IdleTimer()
        self._used_at = monotonic()
        self._answering = 0  # the number of requests that the application has not answered completely
        self._awaits_head = True
        self._awaits_body = False
        self._has_next_head = False  # at least a part of the next head arrived during an answer
        self._head = bytearray()  # bytes of a request that has not arrived completely, or waits for its turn
        self._is_waiting = False
        self._has_begun = False  # the protocol has the head of a request, but perhaps not yet the application
        self._server_has_part = False  # the protocol has a part of a request that followed another one
        self._is_websocket = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Take the connection, or close it or another one if there are too many."""
        self._transport = transport
        self.host = self.holder = (transport.get_extra_info("peername") or ("",))[0]
        admitted = self._connections.admit(self)
        self._protocol.connection_made(transport)
        if admitted:
            self._watch_request()
        else:
            transport.abort()

    def data_received(self, data: bytes) -> None:
        """Take bytes of a request."""
        self._used_at = monotonic()
        self._idle.end()
        if self._answering and not self._awaits_body:
            self._has_next_head = True
        if self._server_has_part and not self._answering:
            self._awaits_head = True
            self._watch_request()
        if self._has_begun or self._answering or self._server_has_part:
            self._pass_on(data)
        else:
            self._collect_head(data)

    def _collect_head(self, data: bytes) -> None:
        """Keep the bytes of a request until its head is complete and its turn has come."""
        looked = len(self._head)
        if not looked and self._answer_early(data):
            return
        self._head += data
        if not looked:
            self._head = self._head.lstrip(b"\r\n")
        if self._is_waiting:
            return
        self._awaits_head = not has_whole_head(self._head, looked)
        self._watch_request()
        if looked and not self._awaits_head and self._answer_early(bytes(self._head)):
            self._head = bytearray()
            return
        if not self._awaits_head and self._transport is not None:
            self._is_waiting = True
            self._transport.pause_reading()
            self._connections.begin(self._head, self._begin_request)

    def _answer_early(self, data: bytes) -> bool:
        """Answer a request by its head alone, if that is possible; not while the client reads slowly."""
        answer_early, transport = self._connections.answer_early, self._transport
        if answer_early is None or transport is None or transport.get_write_buffer_size():
            return False
        request = read_request(data)
        if request is None:
            return False
        token = _current.set(self)
        try:
            answer = answer_early(request)
        finally:
            _current.reset(token)
        if answer is None:
            return False
        self._awaits_head = False
        self._watch_request()
        transport.write(answer)
        self._idle.begin(transport)
        return True

    def _begin_request(self) -> None:
        """Hand the request over to the server."""
        self._is_waiting = False
        if self._transport is None or self.is_closing:
            return
        data, self._head = bytes(self._head), bytearray()
        self._has_begun = True
        self._transport.resume_reading()
        self._pass_on(data)

    def _pass_on(self, data: bytes) -> None:
        token = _current.set(self)
        try:
            self._protocol.data_received(data)
        finally:
            _current.reset(token)

    def eof_received(self) -> bool | None:
        """Take the end of the client's bytes."""
        return self._protocol.eof_received()

    def pause_writing(self) -> None:
        """Make the server wait: the client reads slowly."""
        self._protocol.pause_writing()

    def resume_writing(self) -> None:
        """Let the server continue."""
        self._protocol.resume_writing()

    def connection_lost(self, exc: Exception | None) -> None:
        """End the deadline of the request."""
        self._idle.stop()
        self._stop_watching()
        self._connections.remove(self)
        self._protocol.connection_lost(exc)

    @property
    def is_closing(self) -> bool:
        """True if the connection is closed, or will be."""
        return self._transport is None or self._transport.is_closing()

    def abort(self) -> None:
        """Close the connection at once."""
        if self._transport is not None:
            self._transport.abort()

    def begin_websocket(self) -> None:
        """Note that the connection is a WebSocket, whose number the application limits: it is in use."""
        self._is_websocket, self._awaits_head = True, False
        self._idle.stop()
        self._stop_watching()

    async def answer(self, app: ASGIApp, scope: Scope, receive: Receive, send: Send) -> None:
        """Run the application for a request whose head has arrived."""
        has_turn, self._has_begun = self._has_begun, False
        self._answering += 1
        self._idle.end()
        self._server_has_part = False
        self._awaits_head, self._awaits_body = False, has_body(scope)
        self._watch_request()
        # a request directly behind another one has not waited yet
        if not has_turn and self.proof is not Proof.AUTHENTICATED:
            await self._connections.lane.turn()
        is_complete = False

        async def receive_part() -> Message:
            message = await receive()
            if message["type"] != "http.request" or not message.get("more_body", False):
                self._awaits_body = False
                self._watch_request()
            return message

        async def send_part(message: Message) -> None:
            nonlocal is_complete
            await send(message)
            if message["type"] == "http.response.body" and not message.get("more_body", False):
                is_complete = True
                self._end_answer()

        try:
            await app(scope, receive_part, send_part)
        finally:
            if not is_complete:
                self._end_answer()

    def _end_answer(self) -> None:
        self._answering -= 1
        if not self._answering and self._transport is not None:
            self._idle.begin(self._transport)
        self._awaits_body = False
        self._awaits_head = self._server_has_part = self._has_next_head
        self._has_next_head = False
        self._watch_request()

    @property
    def is_silent(self) -> bool:
        """True while the connection is open and waits for the rest of a request."""
        return self._awaits_request and not self.is_closing

    @property
    def _awaits_request(self) -> bool:
        """True while the head or the body of a request has not arrived completely."""
        return self._awaits_head or self._awaits_body

    def place(self) -> Place[Connection]:
        """Return the place of the connection."""
        if self._awaits_request:
            return Place(self, self.holder, Proof.SILENT, self._used_at)
        is_kept = self._is_websocket or (self._answering and self.proof is Proof.AUTHENTICATED)
        proof = Proof.SPEAKING if self._is_websocket else self.proof
        return Place(self, self.holder, proof, monotonic() if is_kept else self._used_at)

    def _watch_request(self) -> None:
        """Begin to wait for the next part of a request, or end it."""
        if not self._awaits_request:
            self._stop_watching()
        elif self._deadline is None:
            self._deadline = asyncio.get_running_loop().call_later(HEAD_TIMEOUT, self._check_request)

    def _check_request(self) -> None:
        """Close the connection if no part of its request has arrived for too long."""
        self._deadline = None
        is_reading = self._transport is not None and self._transport.is_reading()
        is_late = monotonic() - self._used_at >= HEAD_TIMEOUT and is_reading
        if self._awaits_head or is_late:
            self.abort()
        else:
            self._watch_request()

    def _stop_watching(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


def connection_factory(
    make_protocol: Callable[..., asyncio.Protocol], connections: Connections
) -> Callable[..., Connection]:
    """Return the function that makes the connections of one server.

    Args:
        make_protocol: Makes the protocol of the server for a connection.
        connections: All connections of the server.

    Returns:
        The function, which takes the arguments of `make_protocol`.
    """

    def make(*arguments: object, **settings: object) -> Connection:
        return Connection(make_protocol(*arguments, **settings), connections)

    return make
