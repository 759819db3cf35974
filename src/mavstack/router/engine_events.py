"""The events of the engine of the router."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from typing import Any

#: Source system, source component and message id of the packet that an event is about.
PacketKey: TypeAlias = tuple[int, int, int]

#: An event of the engine: a tuple of its kind, usually the endpoint, and further values.
#:
#: | event | when |
#: |---|---|
#: | `("closed", endpoint, reason)` | the endpoint failed or its stream ended; it is removed |
#: | `("ended",)` | the engine ended by an internal error: nothing is forwarded any more |
#: | `("readable", endpoint)` | an empty queue endpoint got packets to `pull` |
#: | `("inspect", token, endpoint, packet, peer, verified)` | a packet from the endpoint, or from its peer
#: `(host, port)`, waits for `decide(token, …)`; `verified`: its signature is valid |
#: | `("inspect_out", token, endpoint, packet, peer, verified)` | a packet to the endpoint waits |
#: | `("peer", endpoint, (host, port))` | a new peer of a listening socket |
#: | `("peer_closed", endpoint, (host, port))` | a peer was removed because it sent nothing for too long |
#: | `("rule", endpoint, packet_key, name, is_outgoing, is_dry_run)` | a rule dropped a packet |
#: | `("loop", endpoint, packet_key)` | a packet that the router forwarded came back |
#: | `("spoofed", endpoint, packet_key)` | another, authenticated sender holds a packet's address |
#: | `("contested", endpoint, packet_key)` | another sender, as well authenticated, holds a packet's address |
#: | `("signing_key", endpoint, packet_key)` | a SETUP_SIGNING was not forwarded |
#: | `("refused", endpoint, packet_key, reason)` | the signature of a packet is missing or wrong |
#: | `("rebooted", endpoint, packet_key)` | the boot time of the source fell; its routes are learned again |
#:
#: Events about packets are emitted at most once a second for each endpoint and kind (or rule).
RouterEvent: TypeAlias = "tuple[Any, ...]"
