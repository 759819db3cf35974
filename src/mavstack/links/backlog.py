"""Received datagrams that wait because more arrive than can be handled.

The kernel drops datagrams without regard to their sender when its queue is full, so that a flood from one
sender loses the acknowledgements of all others. Under load a link therefore empties the kernel's queue into a
backlog, and handles the datagrams of all senders in turn. If the backlog is full, the senders with the
longest queues lose datagrams; of one sender, those with the message id that it sends most: control messages
are rare and survive. Senders of whom no valid packet was handled have a share of the backlog, so that neither
they nor the others can keep it full. The datagrams of one sender keep their order.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from mavstack.links.address import Address

#: Number of datagrams from which a backlog is full.
DEFAULT_LIMIT = 4096
#: Maximum number of waiting datagrams with a message id that counts as rare.
MAX_RARE = 16
#: A full backlog accepts datagrams of new senders up to 1/NEW_SHARE of its limit.
NEW_SHARE = 8
_MAGIC_V1, _MAGIC_V2 = 0xFE, 0xFD

Datagram: TypeAlias = "tuple[bytes, Address, float]"


class _Queue:
    __slots__ = ("datagrams", "ids")

    def __init__(self) -> None:
        self.datagrams: deque[tuple[Datagram, int, bool]] = deque()
        self.ids: dict[int, int] = {}


class Backlog:
    """A bounded queue of datagrams that is fair to their senders."""

    def __init__(self, limit: int = DEFAULT_LIMIT) -> None:
        self._limit = limit
        self._queues: dict[Address, _Queue] = {}
        self._count = 0
        self._new_count = 0  # waiting datagrams of new senders

    def __len__(self) -> int:
        return self._count

    def add(self, datagram: Datagram, *, known: bool) -> bool:
        """Add a datagram unless its sender has no room; a `known` sender sent valid packets before."""
        data, address, _ = datagram
        queue = self._queues.get(address)
        message_id = first_message_id(data)
        if self._count >= self._limit // 2 and not self._has_room(queue, message_id, known=known):
            return False
        if queue is None:
            queue = self._queues[address] = _Queue()
        queue.datagrams.append((datagram, message_id, known))
        queue.ids[message_id] = queue.ids.get(message_id, 0) + 1
        self._count += 1
        self._new_count += not known
        return True

    def _has_room(self, queue: _Queue | None, message_id: int, *, known: bool) -> bool:
        if self._count >= self._limit and not known and self._new_count >= self._limit // NEW_SHARE:
            return False
        share = self._limit // (len(self._queues) + 1)
        if queue is None or len(queue.datagrams) < share:
            return self._count < 2 * self._limit
        return queue.ids.get(message_id, 0) < MAX_RARE and len(queue.datagrams) < 2 * share

    def pop(self) -> Datagram:
        """Remove and return the next datagram; its sender is served again after all others."""
        address, queue = next(iter(self._queues.items()))
        datagram, message_id, known = queue.datagrams.popleft()
        self._count -= 1
        self._new_count -= not known
        del self._queues[address]
        if queue.datagrams:
            self._queues[address] = queue
            queue.ids[message_id] -= 1
            if not queue.ids[message_id]:
                del queue.ids[message_id]
        return datagram

    def clear(self) -> None:
        """Remove all datagrams."""
        self._queues.clear()
        self._count = self._new_count = 0


def first_message_id(data: bytes) -> int:
    """Return the id of the message with which a datagram begins; -1 if it does not begin with a packet."""
    if len(data) >= 10 and data[0] == _MAGIC_V2:
        return data[7] | data[8] << 8 | data[9] << 16
    return data[5] if len(data) >= 6 and data[0] == _MAGIC_V1 else -1
