"""The records of links through a relay: always sealed between their ends, and datagrams to the relay."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.links.scheme_options import ROLES
from mavstack.links.schemes import ws
from mavstack.links.schemes.sealed import SEAL_OPTIONS

_WSS = ws.SCHEMES[1]
_OPTIONS = {
    **_WSS.options,
    **SEAL_OPTIONS,
    **ROLES,
    "ticket": "the ticket of the room, from `mav relay invite`",
    "tls": "no: connect to the relay without TLS (default: yes)",
}

SCHEMES = (
    LinkScheme(
        name="relay",
        backend="mavstack.links.relay:relay_guest",
        address=AddressKind.WEB,
        example="relay://relay.example?ticket=room1.boat.guest.…&secret=…",
        purpose="Connects to the host of a room of a relay, sealed; needs the extras `web` and `secure`.",
        default_port=443,
        options=_OPTIONS,
    ),
    LinkScheme(
        name="relayin",
        backend="mavstack.links.relay:relay_host",
        address=AddressKind.WEB,
        example="relayin://relay.example?ticket=room1.boat.host.…&secret=…",
        purpose="Takes a room of a relay, and answers its guests, sealed; it dials out.",
        default_port=443,
        options=_OPTIONS,
    ),
)
