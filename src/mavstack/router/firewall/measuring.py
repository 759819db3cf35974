"""The traffic of links, for the detectors, from the counters of the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.router.firewall.detector import Traffic
from mavstack.router.firewall.quarantine import Remote

if TYPE_CHECKING:
    from mavstack.router.engine_statistics import EndpointStatistics
    from mavstack.router.firewall.firewall import Firewall

#: Reasons for dropped packets whose sender has not proved with a signature that it has the key.
SIGNATURE_CAUSES: Final = ("unsigned", "forged", "replayed", "stale", "future", "too_many_streams")


def measure_link(
    firewall: Firewall, name: str, counters: EndpointStatistics, now: float, *, one_signer: bool
) -> None:
    """Give a firewall the traffic of a link and of its peers.

    Args:
        firewall: The firewall.
        name: Name of the link.
        counters: The counters of the link.
        now: Unix time in seconds.
        one_signer: The link has one peer, whose signatures are verified: packets that others send on it, and
            junk, do not count.
    """
    if one_signer:
        refused = sum(counters.dropped.get(cause, 0) for cause in SIGNATURE_CAUSES)
        firewall.measure(name, Traffic(counters.received - refused, 0), now)
    else:
        firewall.measure(name, Traffic(counters.received, counters.bad_bytes), now)
    for each in counters.peers:
        of_peer = Traffic(each.accepted, each.bad_bytes)
        firewall.measure(name, of_peer, now, peer=Remote(each.host, each.port))
