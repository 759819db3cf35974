"""The records of TLS links."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.links.scheme_options import CERTIFICATES, CONNECTION, PEERS, ROLES, VERIFICATION

SCHEMES = (
    LinkScheme(
        name="tls",
        backend="mavstack.links.tls:TlsClient",
        address=AddressKind.HOST,
        example="tls://ground.example:5761?ca=ca.pem",
        purpose="Connects to a TLS server.",
        is_stream=True,
        aliases={"tlsout": {}},
        options={**CONNECTION, **VERIFICATION, "server_name": "name that the server's certificate must have"},
    ),
    LinkScheme(
        name="tlsin",
        backend="mavstack.links.tls:TlsServer",
        address=AddressKind.HOST,
        example="tlsin://0.0.0.0:5761?cert=cert.pem&key=key.pem",
        purpose="Accepts TLS connections, on request only from clients with a certificate.",
        listens=True,
        is_stream=True,
        options={**PEERS, **ROLES, **CERTIFICATES},
    ),
)
