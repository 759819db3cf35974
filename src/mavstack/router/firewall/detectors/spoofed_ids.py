"""Spoofed ids: an address that another sender uses, or another vehicle on this link.

The sender whose heartbeats arrived first keeps an address while they arrive: heartbeats of the address from
another sender are refused, and so are all messages that act upon a vehicle (`mavstack.security.acting`).
Each peer of a UDP port is a sender, and each other link. Links of one group carry the same packets, so they
count as one sender, with one peer each. A sender that is authenticated keeps its addresses against all that
are not. A vehicle that really moves to another link is silent on the first one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import common
from mavstack.router.config.quantities import duration
from mavstack.router.firewall.detector import Detector, make_room, sender_of
from mavstack.security.acting import acting_ids
from mavstack.security.senders import Claims, Sender, Standing
from mavstack.services import Address, message_ids

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.router.config import Table
    from mavstack.router.firewall.alerts import Alert
    from mavstack.wire import Packet

#: Seconds without a heartbeat (three are lost) after which another link may use an address.
DEFAULT_TIMEOUT: Final = 4.0
#: Maximum number of addresses whose vehicle is kept.
MAX_ADDRESSES: Final = 4096


class SpoofedIds(Detector):
    """Refuses heartbeats and acting messages of an address that another sender uses at the same time."""

    name: ClassVar[str] = "spoofed-ids"
    messages: frozenset[int] = message_ids(common.Heartbeat) | acting_ids()

    def __init__(self) -> None:
        self.timeout = DEFAULT_TIMEOUT
        self._claims: Claims[Sender] = Claims(DEFAULT_TIMEOUT)
        self._vehicles: dict[Address, tuple[int, int]] = {}

    def configure(self, options: Table) -> None:
        """Read the options of the detector."""
        self.timeout = options.converted("timeout", duration, self.timeout)
        self._claims = Claims(self.timeout)

    def inspect(self, origin: str, packet: Packet, now: float) -> Iterator[Alert]:
        """Yield the alerts about a packet."""
        address = Address(packet.system, packet.component)
        sender = self._known(sender_of(origin), now)
        if sender is None:
            yield self.alert(origin, packet, "too many senders are in use")
            return
        standing = self._standing(sender, address, packet, now)
        if standing in {Standing.CONTESTED, Standing.OUTRANKED}:
            holder = self._claims.holder(address)
            yield self.alert(origin, packet, f"the address is in use on {holder and holder.sender}")
        elif isinstance(packet.message, common.Heartbeat):
            yield from self._heard(origin, packet, packet.message, standing)

    def _known(self, sender: Sender, now: float) -> Sender | None:
        """Return the sender as the key of its claims, in place of another one if there are too many."""
        while self._claims.sender(sender) is None and not self._claims.open(sender, sender, now):
            evicted = self._claims.first_to_evict(sender, now, everywhere=True)
            if evicted is None:
                return None
            self._claims.close(evicted)
        return sender

    def _standing(self, sender: Sender, address: Address, packet: Packet, now: float) -> Standing:
        if isinstance(packet.message, common.Heartbeat):
            before = self._claims.standing(sender, address, now)
            refused = before in {Standing.CONTESTED, Standing.OUTRANKED}
            return before if refused else self._claims.hear(sender, address, now)
        if self._claims.holder(address) is None:
            return Standing.NEW  # the first heartbeat of the address has not been received yet
        return self._claims.standing(sender, address, now)

    def _heard(
        self, origin: str, packet: Packet, heartbeat: common.Heartbeat, standing: Standing
    ) -> Iterator[Alert]:
        address = Address(packet.system, packet.component)
        vehicle = (int(heartbeat.type), int(heartbeat.autopilot))
        known = self._vehicles.get(address, vehicle)
        holder = self._claims.holder(address)
        moved = standing is Standing.NEW or holder is None or holder.since == holder.heard_at
        if known != vehicle and not moved:
            yield self.alert(origin, packet, "two senders of different type have this address")
            return
        make_room(self._vehicles, MAX_ADDRESSES)
        self._vehicles[address] = vehicle
