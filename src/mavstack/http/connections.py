"""The connections of an HTTP server: bounded in number, with deadlines for requests that do not arrive.

A full server closes a connection for each new one (see `mavstack.security.admission`): first one whose
request has not arrived completely, then one that is unused between two requests or reads its answer slowly,
never one of a client with a session that may act. The application identifies clients by `mark_client`.
"""

from __future__ import annotations

from functools import partial
from time import monotonic
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import MissingExtraError
from mavstack.security.admission import Admission, Place, Proof

try:
    import h11
    from uvicorn.protocols.http.h11_impl import H11Protocol
except ImportError as error:
    raise MissingExtraError("an HTTP server", "web") from error

if TYPE_CHECKING:
    import asyncio
    from collections.abc import Callable, MutableMapping

#: Open connections; the bound leaves descriptors to the links of the program.
MAX_CONNECTIONS: Final = 512
#: Seconds for the head of a request, and between two parts of its body.
HEAD_TIMEOUT: Final = 20.0
_PROOF: Final = "mavstack.proof"
_HOLDER: Final = "mavstack.holder"


def connection_factory() -> Callable[..., asyncio.Protocol]:
    """Return the function that makes the connections of one server."""
    return partial(Connection, admission=Admission(MAX_CONNECTIONS, min_stay=0))


def mark_client(scope: MutableMapping[str, Any], proof: Proof, holder: str) -> None:
    """Tell the server who the client of a request is.

    Args:
        scope: The ASGI scope of the request.
        proof: What the client has proved; `AUTHENTICATED`: its connection is kept while it is in use.
        holder: The name under which its connections are counted with others; empty: its address.
    """
    scope.setdefault("state", {}).update({_PROOF: proof, _HOLDER: holder})


class Connection(H11Protocol):
    """One connection until it becomes a WebSocket.

    Args:
        admission: Decides on new connections.
        arguments: The arguments of the base class.
        settings: Its further arguments.
    """

    def __init__(self, *arguments: Any, admission: Admission, **settings: Any) -> None:  # noqa: ANN401
        super().__init__(*arguments, **settings)
        self._admission = admission
        self._deadline: asyncio.TimerHandle | None = None
        self._used_at = monotonic()

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Take the connection, or close it or another one if there are too many."""
        others = [] if len(self.connections) < self._admission.max_places else self._places()
        super().connection_made(transport)
        host = self.client[0] if self.client else ""
        admitted, leaving = self._admission.admit(host, others, self._used_at)
        if leaving is not None:
            leaving.transport.abort()
        if admitted:
            self._watch_request()
        else:
            transport.abort()

    def data_received(self, data: bytes) -> None:
        """Take bytes of a request."""
        self._used_at = monotonic()
        super().data_received(data)
        self._watch_request()

    def connection_lost(self, exc: Exception | None) -> None:
        """End the deadline of the request."""
        super().connection_lost(exc)
        self._stop_watching()

    @property
    def awaits_request(self) -> bool:
        """True while the head or the body of a request has not arrived completely."""
        return self.conn.their_state in (h11.IDLE, h11.SEND_BODY)

    def place(self) -> Place[Connection]:
        """Return the place of the connection."""
        state = {} if self.scope is None else self.scope.get("state", {})
        holder = state.get(_HOLDER) or (self.client[0] if self.client else "")
        proof = state.get(_PROOF, Proof.SPEAKING)
        is_answered = self.cycle is None or self.cycle.response_complete
        if self.cycle is None or (self.awaits_request and not is_answered):
            return Place(self, holder, Proof.SILENT, self._used_at)
        if proof is Proof.AUTHENTICATED and not is_answered:
            return Place(self, holder, proof, monotonic())
        if is_answered and self.conn.trailing_data[0]:  # the beginning of another request
            return Place(self, holder, Proof.SILENT, self._used_at)
        return Place(self, holder, proof, self._used_at)

    def _places(self) -> list[Place[Any]]:
        return [
            each.place() if isinstance(each, Connection) else _websocket_place(each)
            for each in self.connections
        ]

    def _watch_request(self) -> None:
        """Begin to wait for the next part of a request, or end it."""
        if not self.awaits_request:
            self._stop_watching()
        elif self._deadline is None:
            self._deadline = self.loop.call_later(HEAD_TIMEOUT, self._check_request)

    def _check_request(self) -> None:
        """Close the connection if no part of its request has arrived for too long."""
        self._deadline = None
        waits_for_head = self.conn.their_state is h11.IDLE
        if waits_for_head or (monotonic() - self._used_at >= HEAD_TIMEOUT and not self.flow.read_paused):
            self.transport.abort()
        else:
            self._watch_request()

    def _stop_watching(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


def _websocket_place(protocol: Any) -> Place[Any]:  # noqa: ANN401 (of uvicorn)
    """Return the place of a WebSocket, whose number the application limits: it is in use."""
    client = getattr(protocol, "client", None)
    return Place(protocol, client[0] if client else "", Proof.SPEAKING, monotonic())
