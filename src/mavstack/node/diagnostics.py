"""Diagnostics for discovery timeouts: the traffic received instead, and hints."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.node.host import NodeHost

#: Maximum number of components that an error text lists.
MAX_NAMED = 8


def describe_traffic(host: NodeHost) -> str:
    """Return the components that were heard; if none, the traffic received instead and what to check."""
    heard = sorted(host.components.items())
    if heard:
        names = [
            f"{address} {info.description}{'' if info.alive else ' (silent now)'}"
            for address, info in heard[:MAX_NAMED]
        ]
        more = [f"and {len(heard) - MAX_NAMED} more"] if len(heard) > MAX_NAMED else []
        return f"heard: {', '.join(names + more)}"
    channels = host.engine.channels
    if unheard := host.engine.senders.unmet_limit():
        return unheard
    statistics = [channel.parser.statistics for channel in channels]
    refused = sum(channel.signing.refusals.total for channel in channels if channel.signing is not None)
    if refused:
        return f"{refused} packets were refused: their signatures are missing or made with another key"
    if packets := sum(each.packets for each in statistics):
        return f"heard: {packets} packets, but no heartbeat"
    if bytes_in := sum(each.bad_bytes for each in statistics):
        return f"heard: {bytes_in} bytes that are not MAVLink; check the baud rate and the sender"
    if not channels:
        return "heard: nothing, no link has a peer; check address and port, and that the vehicle is on"
    return "heard: nothing; check address and port, and that the vehicle is on and sends here"
