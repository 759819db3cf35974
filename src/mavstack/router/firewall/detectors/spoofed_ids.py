"""Spoofed ids: an address that is already in use on another link, or by another vehicle on this link.

The link on which an address was heard first keeps it while its heartbeats arrive: heartbeats, commands and
changes of the mission, the mode or a parameter that come from it over another link are refused. Links of one
group carry the same packets and count as one origin. A vehicle that really moves to another link is silent on
the first one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import common
from mavstack.router.config.quantities import duration
from mavstack.router.firewall.detector import Detector, make_room
from mavstack.services import Address, message_ids

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.router.config import Table
    from mavstack.router.firewall.alerts import Alert
    from mavstack.wire import Packet

#: Seconds without a heartbeat after which another link may have an address: three heartbeats are lost.
DEFAULT_TIMEOUT: Final = 4.0
#: Messages that change something, which are rare.
CHANGES: Final = (
    common.CommandLong,
    common.CommandInt,
    common.SetMode,
    common.MissionCount,
    common.MissionClearAll,
    common.MissionSetCurrent,
    common.MissionWritePartialList,
    common.ParamSet,
)
#: Addresses that are remembered.
MAX_ADDRESSES: Final = 4096


@dataclass(slots=True)
class _Owner:
    origin: str
    heard: float
    vehicle: tuple[int, int]


class SpoofedIds(Detector):
    """Refuses heartbeats and commands of an address that another link uses at the same time."""

    name: ClassVar[str] = "spoofed-ids"
    messages: ClassVar[frozenset[int]] = message_ids(common.Heartbeat, *CHANGES)

    def __init__(self) -> None:
        self.timeout = DEFAULT_TIMEOUT
        self._owners: dict[Address, _Owner] = {}

    def configure(self, options: Table) -> None:
        """Read the options of the detector."""
        self.timeout = options.converted("timeout", duration, self.timeout)

    def inspect(self, origin: str, packet: Packet, now: float) -> Iterator[Alert]:
        """Yield the alerts about a packet."""
        match packet.message:
            case common.Heartbeat(type=vehicle_type, autopilot=autopilot):
                yield from self._heard(origin, packet, (int(vehicle_type), int(autopilot)), now)
            case _:
                owner = self._owners.get(Address(packet.system, packet.component))
                if owner is not None and owner.origin != origin and now - owner.heard <= self.timeout:
                    yield self.alert(origin, packet, f"the address is in use on {owner.origin}")

    def _heard(self, origin: str, packet: Packet, vehicle: tuple[int, int], now: float) -> Iterator[Alert]:
        address = Address(packet.system, packet.component)
        owner = self._owners.get(address)
        if owner is None or now - owner.heard > self.timeout:
            make_room(self._owners, MAX_ADDRESSES)
            self._owners.pop(address, None)
            self._owners[address] = _Owner(origin, now, vehicle)
        elif owner.origin != origin:
            yield self.alert(origin, packet, f"the address is in use on {owner.origin}")
        elif owner.vehicle != vehicle:
            yield self.alert(origin, packet, "two senders of different type have this address")
        else:
            owner.heard = now
