"""A WebSocket of an attacker: a connection whose frames are written without a library and without waiting."""

from __future__ import annotations

import socket
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

_REQUEST: Final = """\
GET {path} HTTP/1.1\r
Host: 127.0.0.1:{port}\r
Upgrade: websocket\r
Connection: Upgrade\r
Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r
Sec-WebSocket-Version: 13\r
{protocols}\r
"""
_BINARY: Final = b"\x82"
#: Sizes up to which the second byte of a frame is the size, and its value for a size of two bytes.
_SHORT: Final = 125
_TWO_BYTES: Final = 126
#: The mark of a masked frame; the mask is zero.
_MASKED: Final = 0x80


@contextmanager
def requested(port: int, *protocols: str, path: str = "/") -> Iterator[tuple[socket.socket, bool]]:
    """Ask for a WebSocket.

    Args:
        port: The port of the server.
        protocols: The subprotocols, of which one may be a ticket; none: the header is left out.
        path: The path.

    Yields:
        The connection, and whether the server accepted it.
    """
    offered = f"Sec-WebSocket-Protocol: {', '.join(protocols)}\r\n" if protocols else ""
    with socket.create_connection(("127.0.0.1", port), timeout=5) as connection:
        connection.sendall(_REQUEST.format(path=path, port=port, protocols=offered).encode())
        answer = b""
        while b"\r\n\r\n" not in answer and (received := connection.recv(4096)):
            answer += received
        yield connection, answer.startswith(b"HTTP/1.1 101 ")


def frame(data: bytes) -> bytes:
    """Return a binary frame of at most 65,535 bytes."""
    if len(data) <= _SHORT:
        size = bytes([_MASKED | len(data)])
    else:
        size = bytes([_MASKED | _TWO_BYTES]) + len(data).to_bytes(2)
    return _BINARY + size + bytes(4) + data
