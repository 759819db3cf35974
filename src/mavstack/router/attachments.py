"""The links of the engine by number, and the endpoints that own them."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from mavstack.router.config import RouterConfig
from mavstack.router.filters import rules_of
from mavstack.router.guard import Guard

if TYPE_CHECKING:
    from mavstack.dialects import Dialect
    from mavstack.router.config import EndpointConfig
    from mavstack.router.endpoints.base import Endpoint
    from mavstack.router.engine import RouterEngine
    from mavstack.router.peer import Peer

_log = logging.getLogger("mavstack.router")


class Attachments:
    """The links of one engine.

    Attributes:
        engine: The engine.
        dialect: The dialect of its packets.
        guard: The firewall and the signing gateway.
    """

    def __init__(self, engine: RouterEngine, dialect: Dialect, guard: Guard | None = None) -> None:
        self.engine = engine
        self.dialect = dialect
        self.guard = guard or Guard(engine, RouterConfig(), rules_of)
        self._owners: dict[int, Endpoint] = {}

    def attach(
        self,
        number: int,
        owner: Endpoint,
        name: str = "",
        *,
        peer: Peer | None = None,
        listening: bool = False,
        credential: str = "",
    ) -> None:
        """Give a link to its endpoint; start it with the endpoint's filters and its place in the firewall.

        Args:
            number: Number of the link in the engine, which was added with `start=False`.
            owner: Its endpoint.
            name: Its name; empty: that of the endpoint.
            peer: Address of its peer; None: it has none.
            listening: It is a UDP socket with any number of peers.
            credential: The verified identity of its peer; empty: none.
        """
        self._owners[number] = owner
        self.guard.add(number, name or owner.config.name, peer, listening=listening, credential=credential)
        self.configure(number, owner.config)
        self.engine.start(number)

    def configure(self, number: int, config: EndpointConfig) -> None:
        """Apply a configuration to a link."""
        self.guard.configure(number, config)
        self.engine.set_group(number, config.group or None)
        self.engine.set_listen_only(number, config.listen_only)
        self.engine.pause(number, config.pause)

    def configure_all(self) -> None:
        """Apply all configurations again, after the firewall changed."""
        for number, owner in self._owners.items():
            self.configure(number, owner.config)

    def detach(self, number: int) -> None:
        """Remove a link. Idempotent."""
        self._owners.pop(number, None)
        self.guard.remove(number)
        self.engine.remove(number)

    def owner(self, number: int) -> Endpoint | None:
        """Return the endpoint of a link."""
        return self._owners.get(number)

    def report_bug(self, owner: Endpoint, error: BaseException) -> None:
        """Log an error that ended a task of an endpoint."""
        _log.error("endpoint %s ended: internal error", owner.config.name, exc_info=error)
