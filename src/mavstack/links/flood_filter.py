"""A filter in the kernel against senders that fill the queue of a UDP socket faster than it can be emptied.

The kernel drops datagrams without regard to their sender when the queue is full. While it cannot be emptied,
a small program attached to the socket (classic BPF, Linux only) drops a share of the datagrams of the senders
that sent most, before they are queued, so that the queue has room for the others. The dropped share grows
until the queue can be emptied, and then shrinks slowly to nothing.
"""

from __future__ import annotations

import ipaddress
import socket
import struct
import sys
from collections import Counter
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.links.address import Address

#: Seconds between two adjustments.
ADJUST_INTERVAL: Final = 0.1
#: The share of a filtered sender's datagrams that pass the filter: the first and the smallest share, and the
#: factors by which an adjustment reduces the share while the queue cannot be emptied, and raises it once the
#: queue can be emptied. The steps down are large, because each costs the other senders an interval.
FIRST_PART, MIN_PART, PART_REDUCTION, PART_GROWTH = 0.125, 1 / 8192, 0.25, 1.1
#: Maximum number of filtered senders, and minimum number of datagrams in an interval of a filtered sender.
MAX_SENDERS, MIN_DATAGRAMS = 256, 5

_SO_ATTACH_FILTER, _SO_DETACH_FILTER = 26, 27
_LOAD_HALF, _LOAD_WORD, _JUMP, _JUMP_IF_EQUAL, _JUMP_IF_GREATER, _RETURN = 0x28, 0x20, 0x05, 0x15, 0x25, 0x06
_SOURCE_PORT, _NETWORK_HEADER, _RANDOM = 0, -0x100000, -0x1000 + 56
_SOURCE_OFFSET_4, _SOURCE_OFFSET_6 = 12, 20  # IPv6: the last four bytes of the address
_ACCEPT = 0xFFFF_FFFF


class FloodFilter:
    """The filter of one socket; without effect where the system has none."""

    def __init__(self, sock: socket.socket) -> None:
        self._socket = sock
        self._counts: Counter[Address] = Counter()
        self._reads = self._full_reads = 0
        self._part = 1.0
        self._senders: dict[Address, None] = {}

    @property
    def active(self) -> bool:
        """True if datagrams of some senders are dropped."""
        return bool(self._senders)

    def observe(self, senders: Iterable[Address], *, emptied: bool) -> None:
        """Record the senders of datagrams that were read, and whether the queue was emptied."""
        self._counts.update(senders)
        self._reads += 1
        self._full_reads += not emptied

    def adjust(self, *, overflowed: bool) -> None:
        """Adapt the filter once per interval; `overflowed`: the kernel dropped datagrams meanwhile."""
        if 2 * self._full_reads > self._reads and (self.active or overflowed):
            self._part = max(self._part * PART_REDUCTION, MIN_PART) if self.active else FIRST_PART
            self._add_senders()
            self._attach()
        elif self.active:
            self._part *= PART_GROWTH
            if self._part >= 1:
                self._senders.clear()
            self._attach()
        self._counts.clear()
        self._reads = self._full_reads = 0

    def _add_senders(self) -> None:
        """Add the senders with more than half of the mean number of datagrams."""
        threshold = max(self._counts.total() / (2 * max(len(self._counts), 1)), MIN_DATAGRAMS)
        for address, count in self._counts.most_common(MAX_SENDERS):
            if count >= threshold:
                self._senders[address] = None
        for address in list(self._senders)[:-MAX_SENDERS]:
            del self._senders[address]

    def _attach(self) -> None:
        try:
            if self._senders:
                _attach(self._socket, _program(self._senders, self._part))
            else:
                self._socket.setsockopt(socket.SOL_SOCKET, _SO_DETACH_FILTER, 0)
        except OSError:  # the process may not set filters: the senders are not filtered
            self._senders.clear()


def _program(senders: Iterable[Address], part: float) -> bytes:
    """Return the program that passes only a share (`part`) of the datagrams of these senders."""
    entries = [_match(address) for address in senders]
    length = sum(len(entry) + 1 for entry in entries)
    code: list[tuple[int, int, int, int]] = []
    for entry in entries:
        code += entry
        code.append((_JUMP, 0, 0, length - len(code)))  # jump over the other entries, to the random choice
    code += [
        (_RETURN, 0, 0, _ACCEPT),
        (_LOAD_WORD, 0, 0, _RANDOM & _ACCEPT),
        (_JUMP_IF_GREATER, 0, 1, int(part * _ACCEPT)),
        (_RETURN, 0, 0, 0),
        (_RETURN, 0, 0, _ACCEPT),
    ]
    return b"".join(struct.pack("=HBBI", *instruction) for instruction in code)


def _match(address: Address) -> list[tuple[int, int, int, int]]:
    """Return instructions that skip the next one unless a datagram is from this address and port."""
    source = ipaddress.ip_address(address[0].partition("%")[0])
    if source.version == 6:
        source = source.ipv4_mapped or source
    offset = _SOURCE_OFFSET_4 if source.version == 4 else _SOURCE_OFFSET_6
    return [
        (_LOAD_HALF, 0, 0, _SOURCE_PORT),
        (_JUMP_IF_EQUAL, 0, 3, address[1]),
        (_LOAD_WORD, 0, 0, (_NETWORK_HEADER + offset) & _ACCEPT),
        (_JUMP_IF_EQUAL, 0, 1, int.from_bytes(source.packed[-4:], "big")),
    ]


def _attach(sock: socket.socket, program: bytes) -> None:
    if sys.platform != "linux":
        raise OSError("the system has no such filter")
    import ctypes  # a slow import, which only floods need

    code = ctypes.create_string_buffer(program, len(program))
    header = struct.pack("HL", len(program) // 8, ctypes.addressof(code))
    sock.setsockopt(socket.SOL_SOCKET, _SO_ATTACH_FILTER, header)
