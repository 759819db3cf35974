"""What was heard by someone who waited for somebody in vain: said so that one knows what to look at."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.node.node import Node

#: So many components are named.
MOST_NAMED = 8


def what_was_heard(node: Node) -> str:
    """Who was heard; if nobody was, what came instead, and what to look at."""
    heard = sorted(node.components.items())
    if heard:
        names = [
            f"{address} {info.kind}{'' if info.alive else ' (silent now)'}"
            for address, info in heard[:MOST_NAMED]
        ]
        more = [f"and {len(heard) - MOST_NAMED} more"] if len(heard) > MOST_NAMED else []
        return f"heard: {', '.join(names + more)}"
    statistics = [channel.parser.statistics for channel in node.engine.channels]
    refused = sum(
        channel.signing.refusals.total for channel in node.engine.channels if channel.signing is not None
    )
    if refused:
        return f"{refused} packets were refused: their signatures are missing or of another key"
    if packets := sum(each.packets for each in statistics):
        return f"heard: {packets} packets, but no heartbeat"
    if bytes_in := sum(each.bad_bytes for each in statistics):
        return f"heard: {bytes_in} bytes that are not MAVLink; look at the baud rate, and what sends them"
    if not node.engine.channels:
        return "heard: nobody, as no link has a peer; look at address and port, and whether the vehicle is on"
    return "heard: nobody; look at address and port, and whether the vehicle is on and sends here"
