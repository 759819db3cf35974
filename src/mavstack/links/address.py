"""Socket addresses: from a host name, and into text."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import socket

Address: TypeAlias = tuple[Any, ...]


async def resolve(
    host: str, port: int, kind: socket.SocketKind
) -> list[tuple[socket.AddressFamily, Address]]:
    """All addresses of a host; raises `socket.gaierror` if it has none."""
    found = await asyncio.get_running_loop().getaddrinfo(host, port, type=kind)
    return [(family, address) for family, _, _, _, address in found]


def format_address(address: Address | None) -> str:
    """`host:port`, with the brackets of IPv6."""
    if not address:
        return "unknown"
    host, port = address[:2]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
