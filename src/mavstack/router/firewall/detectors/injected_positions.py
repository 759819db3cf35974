"""Injected positions: messages that tell an autopilot where it is, from a sender that is not known to do so.

HIL_GPS and GPS_INPUT move a vehicle's estimate of its position without any other sign. Simulators and
companion computers with a positioning system send them; the option `allow` names these.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from mavstack.dialects import common
from mavstack.router.firewall.detector import Detector
from mavstack.router.firewall.sources import source
from mavstack.services import Address, message_ids

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.router.config import Table
    from mavstack.router.firewall.alerts import Alert
    from mavstack.wire import Packet


class InjectedPositions(Detector):
    """Refuses positions and sensor values from senders that are not allowed to send them."""

    name: ClassVar[str] = "injected-positions"
    messages: frozenset[int] = message_ids(
        common.HilGps, common.HilSensor, common.HilStateQuaternion, common.GpsInput, common.GpsInjectData
    )

    def __init__(self) -> None:
        self.allowed: frozenset[Address] = frozenset()

    def configure(self, options: Table) -> None:
        """Read the options of the detector."""
        self.allowed = frozenset(options.members("allow", source))

    def inspect(self, origin: str, packet: Packet, now: float) -> Iterator[Alert]:
        """Yield the alerts about a packet."""
        if Address(packet.system, packet.component) not in self.allowed:
            yield self.alert(origin, packet, f"{packet.name} from a sender that is not allowed to send it")
