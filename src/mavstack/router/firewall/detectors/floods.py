"""Floods: an endpoint that sends more packets, or more bytes that are no packets, than a link of its kind."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.router.config.quantities import byte_rate, hertz
from mavstack.router.firewall.detector import Detector, Traffic, make_room

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.router.config import Table
    from mavstack.router.firewall.alerts import Alert

#: Packets and invalid bytes per second that no vehicle exceeds, even with all streams at high rates.
DEFAULT_MAX_PACKETS: Final = 5000.0
DEFAULT_MAX_BAD_BYTES: Final = 20_000.0
MAX_ORIGINS: Final = 4096
#: Minimum seconds between two readings of the counters from which a rate is calculated.
_MIN_INTERVAL: Final = 0.2


class Floods(Detector):
    """Reports endpoints over a limit; with quarantine they are cut off for a time."""

    name: ClassVar[str] = "floods"

    def __init__(self) -> None:
        self.max_packets, self.max_bad_bytes = DEFAULT_MAX_PACKETS, DEFAULT_MAX_BAD_BYTES
        self._last: dict[str, tuple[float, Traffic]] = {}

    def configure(self, options: Table) -> None:
        """Read the options of the detector."""
        self.max_packets = options.converted("max_packets", hertz, self.max_packets)
        self.max_bad_bytes = options.converted("max_bad_bytes", byte_rate, self.max_bad_bytes)

    def measure(self, origin: str, traffic: Traffic, now: float) -> Iterator[Alert]:
        """Yield the alerts about the counters of an endpoint."""
        last = self._last.get(origin)
        if last is not None and now - last[0] < _MIN_INTERVAL:
            return
        make_room(self._last, MAX_ORIGINS)
        self._last[origin] = (now, traffic)
        if last is None:
            return
        seconds, before = now - last[0], last[1]
        packets = (traffic.packets - before.packets) / seconds
        bad_bytes = (traffic.bad_bytes - before.bad_bytes) / seconds
        if packets > self.max_packets:
            yield self.alert(origin, None, f"{packets:.0f} packets/s, more than {self.max_packets:.0f}")
        if bad_bytes > self.max_bad_bytes:
            yield self.alert(origin, None, f"{bad_bytes:.0f} bad bytes/s, more than {self.max_bad_bytes:.0f}")
