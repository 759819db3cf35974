"""The records of links over Unix sockets."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.links.scheme_options import PEERS, RECONNECTION

_FRAMING = {"framing": "length: each chunk of packets is preceded by its length, 4 bytes in big-endian order"}

SCHEMES = (
    LinkScheme(
        name="unix",
        backend="mavstack.links.unix:UnixClient",
        address=AddressKind.PATH,
        example="unix:///run/mavlink.sock",
        purpose="Connects to a Unix socket.",
        is_stream=True,
        options={**RECONNECTION, **_FRAMING},
    ),
    LinkScheme(
        name="unixin",
        backend="mavstack.links.unix:UnixServer",
        address=AddressKind.PATH,
        example="unixin:///run/mavlink.sock",
        purpose="Accepts connections on a Unix socket.",
        listens=True,
        is_stream=True,
        options={**PEERS, **_FRAMING},
    ),
)
