"""The proofs of the clients of servers, as the engine knows them: for the admission of further clients.

The engine counts the packets of each link and verifies signatures, without a notice for each packet. The
counters are therefore read when a server is full, at most every `LOOK_INTERVAL` seconds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidStateError
from mavstack.security.admission import Place, Proof

if TYPE_CHECKING:
    from mavstack.router.engine import RouterEngine

#: Seconds between two readings of the engine's counters.
LOOK_INTERVAL: Final = 0.25


@dataclass(slots=True)
class _Client:
    """A client, and when it was heard last."""

    host: str
    used_at: float
    received: int = 0
    is_authenticated: bool = False


class ClientProofs:
    """The clients of one server.

    Args:
        engine: The engine, which knows their packets.
    """

    def __init__(self, engine: RouterEngine) -> None:
        self._engine = engine
        self._clients: dict[int, _Client] = {}
        self._looked_at = float("-inf")

    def add(self, number: int, host: str, now: float) -> None:
        """Add a client.

        Args:
            number: Its number in the engine.
            host: Its address, without the port.
            now: The time in seconds.
        """
        self._clients[number] = _Client(host, now)

    def remove(self, number: int) -> None:
        """Remove a client. Idempotent."""
        self._clients.pop(number, None)

    def places(self, now: float) -> list[Place[int]]:
        """Return the places of the clients, by their numbers in the engine."""
        if now - self._looked_at >= LOOK_INTERVAL:
            self._looked_at = now
            self._look(now)
        return [
            Place(number, client.host, _proof(client), client.used_at)
            for number, client in self._clients.items()
        ]

    def _look(self, now: float) -> None:
        try:
            statistics = self._engine.statistics()
        except InvalidStateError:  # the router is closing
            return
        verified = {number for route in statistics.routes if route.verified for number in route.endpoints}
        for number, client in self._clients.items():
            counted = statistics.endpoints.get(number)
            if counted is not None and counted.received > client.received:
                client.received, client.used_at = counted.received, now
            client.is_authenticated |= number in verified


def _proof(client: _Client) -> Proof:
    if client.is_authenticated:
        return Proof.AUTHENTICATED
    return Proof.SPEAKING if client.received else Proof.SILENT
