"""Joining of received datagrams, for readers that parse the datagrams of a sender as one stream of bytes.

A parser finds the same packets however a stream is cut into chunks, so joining loses nothing, and one event
costs much less than many. Only datagrams that follow each other, with the same sender and time, are joined:
the order of the events stays that of the datagrams.
"""

from __future__ import annotations

from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.links.address import Address
    from mavstack.links.backlog import Datagram

#: Maximum number of joined bytes, by which an event may exceed the receive queue.
MAX_JOINED: Final = 1 << 16

_SENDER_AND_TIME: Final = itemgetter(1, 2)


def join_datagrams(datagrams: Iterable[Datagram]) -> Iterator[tuple[bytes, Address, float, int]]:
    """Yield the bytes of datagrams, joined where possible, with sender, time and number of datagrams."""
    for (address, time), group in groupby(datagrams, _SENDER_AND_TIME):
        parts = [datagram[0] for datagram in group]
        data = b"".join(parts)
        if len(data) <= MAX_JOINED:
            yield data, address, time, len(parts)
        else:
            for part in parts:
                yield part, address, time, 1
