"""The shares of clients in the WebSockets and streams of a station, which cost work for each packet.

Clients that observe have a part of all places together, so that there is always a place for a client that
acts; and each session has a share, so that one client leaves places to the others.
"""

from __future__ import annotations

from collections import Counter
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.server.access import Client

#: Maximum number of WebSockets and streams: of all clients, of all observing clients, and of one session.
MAX_STREAMS: Final = 256
MAX_OBSERVED_STREAMS: Final = 96
MAX_STREAMS_PER_SESSION: Final = 16


class ClientShares:
    """The open WebSockets and streams of a station."""

    def __init__(self) -> None:
        self._sessions: Counter[str] = Counter()
        self._observed = 0

    def __len__(self) -> int:
        return self._sessions.total()

    @contextmanager
    def place(self, client: Client) -> Iterator[None]:
        """Take a place for a client while the context is open.

        Args:
            client: The client; without a session it shares all places with others of this machine.

        Raises:
            RefusedError: The client, the clients that observe, or all together have as many as they may have.
        """
        self._check(client)
        observes = client.role is Role.OBSERVE
        self._sessions[client.session] += 1
        self._observed += observes
        try:
            yield
        finally:
            self._observed -= observes
            self._sessions[client.session] -= 1
            if not self._sessions[client.session]:
                del self._sessions[client.session]

    def _check(self, client: Client) -> None:
        if len(self) >= MAX_STREAMS:
            raise RefusedError(429, f"{MAX_STREAMS} WebSockets and streams are open already")
        if client.role is Role.OBSERVE and self._observed >= MAX_OBSERVED_STREAMS:
            raise RefusedError(
                429, f"clients that observe have {MAX_OBSERVED_STREAMS} WebSockets and streams open already"
            )
        if client.session and self._sessions[client.session] >= MAX_STREAMS_PER_SESSION:
            raise RefusedError(
                429, f"this session has {MAX_STREAMS_PER_SESSION} WebSockets and streams open already"
            )
