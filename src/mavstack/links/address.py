"""Socket addresses: resolving host names, and formatting."""

from __future__ import annotations

import asyncio
import socket
from typing import Any, Final, TypeAlias

Address: TypeAlias = tuple[Any, ...]

#: The first byte of the IPv4 loopback network 127.0.0.0/8, and the IPv6 loopback address ::1.
_LOOPBACK_NETWORK: Final = 127
_LOOPBACK_6: Final = bytes(15) + b"\1"


async def resolve(
    host: str, port: int, kind: socket.SocketKind
) -> list[tuple[socket.AddressFamily, Address]]:
    """Resolve a host name to all its addresses; raises `socket.gaierror` if it has none."""
    try:
        # A numeric address is resolved without a thread. As bytes, the host needs no import of the IDNA
        # codec.
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
    local, any_address = ("::1", "::") if ":" in remote[0] else ("127.0.0.1", "0.0.0.0")  # noqa: S104
    return local if is_loopback(remote[0]) else any_address


def is_loopback(host: str) -> bool:
    """Return true for an IP address that only this machine reaches; false for all other texts."""
    try:
        packed = packed_ip((host,))
    except (OSError, ValueError):  # `host` is not an IP address
        return False
    return packed == _LOOPBACK_6 if len(packed) > 4 else packed[0] == _LOOPBACK_NETWORK


def packed_ip(address: Address) -> bytes:
    """Return the 4 or 16 bytes of the IP address of a socket address, without its scope."""
    host = address[0].partition("%")[0]
    return socket.inet_pton(socket.AF_INET6 if ":" in host else socket.AF_INET, host)


def is_multicast(packed: bytes) -> bool:
    """Return true for the bytes of a multicast group."""
    return packed[0] == 0xFF if len(packed) > 4 else packed[0] >> 4 == 0xE
