"""The records of WebSocket links. A message may have several packets, as a chunk of a stream has."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.links.scheme_options import CERTIFICATES, CONNECTION, PEERS, ROLES, VERIFICATION

_BOTH = {
    "origin": "the Origin header to send, or, on a server, to require",
    "subprotocol": "subprotocols to offer, or, on a server, to accept: one or several, with commas",
    "ticket_key": "file or name of the key of tickets: a client makes one, a server requires one",
    "token": "the bearer token to show, or, on a server, to require; with `ticket_key` either is enough",
}
_CLIENT = {
    **_BOTH,
    **CONNECTION,
    "header.NAME": "a header to send, such as `header.X-Vehicle=7`",
    "query.NAME": "a field of the query string to send, such as `query.room=7`",
}
_SERVER = {**_BOTH, **PEERS, **ROLES}

SCHEMES = (
    LinkScheme(
        name="ws",
        backend="mavstack.links.ws:WsClient",
        address=AddressKind.WEB,
        example="ws://127.0.0.1:5770/mavlink",
        purpose="Connects to a WebSocket server; needs the extra `web`.",
        is_stream=True,
        default_port=80,
        options=_CLIENT,
    ),
    LinkScheme(
        name="wss",
        backend="mavstack.links.ws:WsClient",
        address=AddressKind.WEB,
        example="wss://ground.example/mavlink",
        purpose="Connects to a WebSocket server over TLS; needs the extra `web`.",
        is_stream=True,
        default_port=443,
        options={**_CLIENT, **VERIFICATION},
    ),
    LinkScheme(
        name="wsin",
        backend="mavstack.links.ws:WsServer",
        address=AddressKind.WEB,
        example="wsin://0.0.0.0:5770",
        purpose="Accepts WebSocket connections; needs the extra `web`.",
        listens=True,
        is_stream=True,
        aliases={"wsserver": {}},
        options=_SERVER,
    ),
    LinkScheme(
        name="wssin",
        backend="mavstack.links.ws:WsServer",
        address=AddressKind.WEB,
        example="wssin://0.0.0.0:5770?cert=cert.pem&key=key.pem",
        purpose="Accepts WebSocket connections over TLS; needs the extra `web`.",
        listens=True,
        is_stream=True,
        options={**_SERVER, **CERTIFICATES},
    ),
)
