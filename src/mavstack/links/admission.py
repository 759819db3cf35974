"""Admission of new peers to a link that has as many peers as it may have.

Any host can open many ports or connections; these must not lock out a vehicle that comes later. A full link
closes the channel of the peer that is least worth keeping: one that never sent a valid packet, else one whose
last valid packet is old, of the host with the most peers. Which packets are valid is decided by the reader of
the link: with signing, only packets with a valid signature. The rate is limited, so that a peer stays long
enough to send a valid packet, however many others come.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

    from mavstack.links.channel import Channel

#: Seconds after its last valid packet for which a peer is kept.
VALID_TIMEOUT = 3.0
#: Mean time in seconds for which a new peer of a full link stays at least.
MIN_STAY = 4.0


class Admission:
    """Chooses the peers of one link that make room for new ones."""

    def __init__(self, max_peers: int) -> None:
        self._max_peers = max_peers
        self._burst = max(1.0, max_peers / 4)
        self._allowance = self._burst
        self._updated = 0.0

    def admit(self, host: str, peers: Collection[Channel], now: float) -> bool:
        """Return whether a new peer of `host` may be added; a full link closes another channel for it."""
        if len(peers) < self._max_peers:
            return True
        elapsed, self._updated = max(0.0, now - self._updated), now
        self._allowance = min(self._burst, self._allowance + elapsed * self._max_peers / MIN_STAY)
        if self._allowance < 1:
            return False
        chosen = self._choose(host, peers, now)
        if chosen is None:
            return False
        self._allowance -= 1
        chosen.close("closed to make room for another peer")
        return True

    def _choose(self, host: str, peers: Collection[Channel], now: float) -> Channel | None:
        hosts = Counter(peer.host for peer in peers)
        candidates = [peer for peer in peers if now - peer.last_valid > VALID_TIMEOUT]
        if not candidates and hosts:
            largest, count = hosts.most_common(1)[0]
            if largest != host and count > self._max_peers // 2:
                candidates = [peer for peer in peers if peer.host == largest]
        return min(
            candidates,
            key=lambda peer: (peer.last_valid > 0, -hosts[peer.host], peer.last_valid, peer.last_received),
            default=None,
        )
