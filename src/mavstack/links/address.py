"""Socket addresses: resolving host names, and formatting."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import socket

Address: TypeAlias = tuple[Any, ...]


async def resolve(
    host: str, port: int, kind: socket.SocketKind
) -> list[tuple[socket.AddressFamily, Address]]:
    """Resolve a host name to all its addresses; raises `socket.gaierror` if it has none."""
    resolved = await asyncio.get_running_loop().getaddrinfo(host, port, type=kind)
    return [(family, address) for family, _, _, _, address in resolved]


def format_address(address: Address | None) -> str:
    """Format an address as `host:port`, with brackets around an IPv6 host."""
    if not address:
        return "unknown"
    host, port = address[:2]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
