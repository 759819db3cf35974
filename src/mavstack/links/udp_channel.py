"""A channel of a UDP link: one remote address.

A thread of the core may parse what the peer sends (see `native_reading`); the channel then learns what was
received when its counters and times are read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.links.address import Address, format_address
from mavstack.links.channel import Channel, Counters, Data

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links.probation import Probation
    from mavstack.links.udp import UdpLink


class UdpChannel(Channel):
    """A channel to one remote address.

    Attributes:
        address: The remote address.
        probation: The limit for a new peer; None: there is no limit.
        refresh: Called before counters or times are read; calls `note_received`.
        on_removed: Called when the channel closes.
    """

    def __init__(
        self, name: str, address: Address, on_closed: Callable[[Channel, str], None], link: UdpLink
    ) -> None:
        self.refresh: Callable[[], None] = lambda: None
        self.on_removed: Callable[[], None] = lambda: None
        super().__init__(name, format_address(address), on_closed)
        self.address = address
        self.probation: Probation | None = None
        self._link = link

    @property
    def counters(self) -> Counters:
        """Counters of this channel."""
        self.refresh()
        return self._counters

    @counters.setter
    def counters(self, counters: Counters) -> None:
        self._counters = counters

    @property
    def last_received(self) -> float:
        """Unix time of the last received bytes in seconds; before any, of the opening."""
        self.refresh()
        return self._last_received

    @last_received.setter
    def last_received(self, time: float) -> None:
        self._last_received = time

    @property
    def last_valid(self) -> float:
        """Unix time of the last valid packet in seconds; 0: none yet."""
        self.refresh()
        return self._last_valid

    @last_valid.setter
    def last_valid(self, time: float) -> None:
        self._last_valid = time

    def note_received(self, size: int, chunks: int, received_at: float, valid_at: float) -> None:
        """Record bytes that were received elsewhere; the times are Unix times in seconds."""
        self._counters.bytes_in += size
        self._counters.chunks_in += chunks
        self._last_received = max(self._last_received, received_at)
        self._last_valid = max(self._last_valid, valid_at)

    def send_bytes(self, data: Data) -> bool:
        """Send or queue a chunk."""
        if self.probation is not None and not self.probation.may_send(data):
            return False
        return self._link.send_to(data, self)

    def close_transport(self) -> None:
        """Start closing the transport."""
        self.on_removed()
        self._link.remove_channel(self)
