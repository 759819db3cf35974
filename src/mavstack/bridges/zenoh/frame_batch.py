"""Packets that wait to be put as one sample, so that a read of many packets costs one sample."""

from __future__ import annotations

from typing import Final

#: Maximum size of a sample in bytes: it fits into one datagram on most networks.
MAX_BYTES: Final = 1400


class FrameBatch:
    """The packets of one vehicle; whole packets only, in their order.

    Args:
        limit: Bytes of a sample; a larger packet is a sample of its own.
    """

    def __init__(self, limit: int = MAX_BYTES) -> None:
        self._limit = limit
        self._parts: list[bytes] = []
        self._size = 0

    @property
    def is_empty(self) -> bool:
        """True if no packet waits."""
        return not self._parts

    def add(self, packet: bytes) -> bytes:
        """Add a packet.

        Args:
            packet: Its bytes.

        Returns:
            The sample that had no room for it; empty if the packet waits.
        """
        full = self.take() if self._parts and self._size + len(packet) > self._limit else b""
        self._parts.append(packet)
        self._size += len(packet)
        return full

    def take(self) -> bytes:
        """Return the packets that wait, and forget them; empty if there are none."""
        data = b"".join(self._parts)
        self._parts.clear()
        self._size = 0
        return data
