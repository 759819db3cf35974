"""The records of TCP links."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.links.scheme_options import CONNECTION, PEERS, ROLES

SCHEMES = (
    LinkScheme(
        name="tcpin",
        backend="mavstack.links.tcp:TcpServer",
        address=AddressKind.HOST,
        example="tcpin://0.0.0.0:5760",
        purpose="Accepts TCP connections; each is a channel.",
        listens=True,
        is_stream=True,
        options={**PEERS, **ROLES},
    ),
    LinkScheme(
        name="tcpout",
        backend="mavstack.links.tcp:TcpClient",
        address=AddressKind.HOST,
        example="tcpout://127.0.0.1:5760",
        purpose="Connects to a TCP server, and again when the connection breaks.",
        is_stream=True,
        aliases={"tcp": {}},
        options=CONNECTION,
    ),
)
