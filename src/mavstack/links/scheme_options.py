"""The meaning of options that the schemes of several backends have, for the records of these schemes."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

#: Options of links with a limited number of peers.
PEERS: Final[Mapping[str, str]] = MappingProxyType(
    {"max_peers": "peers at the same time; a new one replaces the idlest that sent no valid packet"}
)
#: Options of servers with roles for their clients.
ROLES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "role": "what clients may send at most: observe, operate or administer",
        "roles": "file with a line for each client: its role and its identity; others observe",
    }
)
#: Options of links that reconnect.
RECONNECTION: Final[Mapping[str, str]] = MappingProxyType(
    {
        "reconnect": "connect again after the connection is lost",
        "retry": "delay before the first new attempt",
        "retry_limit": "longest delay between attempts",
        "wait": "let `open` wait until the first attempt succeeds, instead of raising",
    }
)
#: Options of links that connect over a network.
CONNECTION: Final[Mapping[str, str]] = MappingProxyType(
    {**RECONNECTION, "timeout": "time limit of one attempt to connect"}
)
#: Options of both ends of TLS.
CERTIFICATES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "ca": "file with the authorities to trust; on a server: clients must show a certificate of theirs",
        "cert": "file with the own certificate",
        "key": "file with the private key of `cert`",
    }
)
#: Options of the client side of TLS.
VERIFICATION: Final[Mapping[str, str]] = MappingProxyType(
    {**CERTIFICATES, "insecure": "do not verify the server's certificate (tests only)"}
)
