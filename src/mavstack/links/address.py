"""Socket addresses: resolving host names, and formatting."""

from __future__ import annotations

import asyncio
import ipaddress
import socket
from typing import Any, TypeAlias

Address: TypeAlias = tuple[Any, ...]


async def resolve(
    host: str, port: int, kind: socket.SocketKind
) -> list[tuple[socket.AddressFamily, Address]]:
    """Resolve a host name to all its addresses; raises `socket.gaierror` if it has none."""
    try:
        # An IP address needs no thread; bytes need no table of international names.
        resolved = socket.getaddrinfo(host.encode("ascii"), port, type=kind, flags=socket.AI_NUMERICHOST)
    except (socket.gaierror, UnicodeEncodeError):
        resolved = await asyncio.get_running_loop().getaddrinfo(host, port, type=kind)
    return [(family, address) for family, _, _, _, address in resolved]


def format_address(address: Address | None) -> str:
    """Format an address as `host:port`, with brackets around an IPv6 host."""
    if not address:
        return "unknown"
    host, port = address[:2]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


async def resolve_datagram(host: str, port: int) -> tuple[socket.AddressFamily, Address]:
    """Resolve a host name for UDP, preferring IPv4: `localhost` must reach a listener on 0.0.0.0."""
    addresses = await resolve(host, port, socket.SOCK_DGRAM)
    return min(addresses, key=lambda entry: entry[0] != socket.AF_INET)


def local_address(remote: Address) -> str:
    """Return the local address for a socket that sends to `remote`: loopback for loopback, else any."""
    target = ip_of(remote)
    if target.version == 6:
        return "::1" if target.is_loopback else "::"
    return "127.0.0.1" if target.is_loopback else "0.0.0.0"  # noqa: S104


def ip_of(address: Address) -> ipaddress.IPv4Address | ipaddress.IPv6Address:
    """Return the IP address of a socket address, without its scope."""
    return ipaddress.ip_address(address[0].partition("%")[0])
