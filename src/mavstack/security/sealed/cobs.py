"""Datagrams over a byte stream by COBS: no zero byte inside, a zero byte behind each.

A receiver that lost bytes continues behind the next zero byte. A datagram grows by 2 bytes, and by one more
for each 254 bytes.
"""

from __future__ import annotations

from typing import Final

#: Maximum size of a datagram; more bytes without a zero byte are not a datagram.
MAX_DATAGRAM: Final = 1 << 16
_MAX_BLOCK: Final = 254


def encode(datagram: bytes) -> bytes:
    """Return a datagram as bytes for a stream."""
    stream = bytearray()
    for block in datagram.split(b"\0"):
        rest = block
        while len(rest) >= _MAX_BLOCK:
            stream.append(_MAX_BLOCK + 1)
            stream += rest[:_MAX_BLOCK]
            rest = rest[_MAX_BLOCK:]
        stream.append(len(rest) + 1)
        stream += rest
    stream.append(0)
    return bytes(stream)


class Decoder:
    """Splits a stream, in chunks of any size, into datagrams.

    Attributes:
        junk: Bytes that belonged to no datagram.
    """

    def __init__(self) -> None:
        self._rest = b""
        self.junk = 0

    def feed(self, chunk: bytes) -> list[bytes]:
        """Add a chunk; return the complete datagrams."""
        *complete, rest = (self._rest + chunk).split(b"\0")
        if len(rest) > MAX_DATAGRAM + MAX_DATAGRAM // _MAX_BLOCK:
            self.junk += len(rest)
            rest = b""
        self._rest = rest
        datagrams = []
        for block in complete:
            datagram = _decode(block)
            if datagram is None:
                self.junk += len(block)
            elif datagram:
                datagrams.append(datagram)
        return datagrams


def _decode(block: bytes) -> bytes | None:
    """Return a datagram without its codes; None if they do not fit."""
    parts, position = [], 0
    while position < len(block):
        code = block[position]
        part = block[position + 1 : position + code]
        if len(part) != code - 1:
            return None
        position += code
        parts.append(part)
        if code <= _MAX_BLOCK and position < len(block):
            parts.append(b"\0")
    return b"".join(parts)
