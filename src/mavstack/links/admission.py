"""Admission of new peers to a full link (see `mavstack.security.admission`).

Which packets are valid is decided by the reader of the link: with signing, only packets with a valid
signature. A peer whose identity is proved, by a certificate, a key or a signature, is preferred to others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.security.admission import Admission, Place, Proof

if TYPE_CHECKING:
    from collections.abc import Collection

    from mavstack.links.channel import Channel


class PeerAdmission:
    """Chooses the peers of one link that make room for new ones."""

    def __init__(self, max_peers: int) -> None:
        self._admission = Admission(max_peers)

    def admit(self, host: str, peers: Collection[Channel], now: float, proof: Proof = Proof.SILENT) -> bool:
        """Return whether a new peer may be added; a full link closes another channel for it.

        Args:
            host: The host of the new peer.
            peers: The channels of the link.
            now: Unix time in seconds.
            proof: What the new peer has proved already.

        Returns:
            True if it may.
        """
        if len(peers) < self._admission.max_places:
            return True
        admitted, leaving = self._admission.admit(host, [_place(each) for each in peers], now, proof)
        if leaving is not None:
            leaving.close("closed to make room for another peer")
        return admitted


def _place(channel: Channel) -> Place[Channel]:
    """Return the place of a channel: it is used by its valid packets, before the first one by any bytes."""
    valid = channel.last_valid
    return Place(channel, channel.host, channel.proof, valid or channel.last_received)
