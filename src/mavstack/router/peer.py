"""The address of the other end of a link of the router."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Peer:
    """The other end of a link that has an address; serial ports have none.

    Attributes:
        host: IP address, without a scope.
        port: Its port.
    """

    host: str
    port: int
