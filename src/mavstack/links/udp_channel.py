"""A channel of a UDP link: one remote address."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.links.address import Address, format_address
from mavstack.links.channel import Channel, Data

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links.probation import Probation
    from mavstack.links.udp import UdpLink


class UdpChannel(Channel):
    """A channel to one remote address.

    Attributes:
        address: The remote address.
        probation: The limit for a new peer; None: there is no limit.
    """

    def __init__(
        self, name: str, address: Address, on_closed: Callable[[Channel, str], None], link: UdpLink
    ) -> None:
        super().__init__(name, format_address(address), on_closed)
        self.address = address
        self.probation: Probation | None = None
        self._link = link

    def send_bytes(self, data: Data) -> bool:
        """Send or queue a chunk."""
        if self.probation is not None and not self.probation.may_send(data):
            return False
        return self._link.send_to(data, self)

    def close_transport(self) -> None:
        """Start closing the transport."""
        self._link.remove_channel(self)
