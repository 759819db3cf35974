"""The closed family of events that iterating over a link yields.

Each `ChannelOpened` is followed by exactly one `ChannelClosed` of the same channel, and all
`BytesReceived` of a channel lie between the two. Events are plain tuples: one is made for every datagram.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

if TYPE_CHECKING:
    from mavstack.links.channel import Channel


class ChannelOpened(NamedTuple):
    """A peer appeared."""

    channel: Channel


class BytesReceived(NamedTuple):
    """Bytes of a peer: one datagram, or any piece of a stream; `time` is in unix seconds.

    `time` is when the bytes arrived, or for a replayed recording when they were recorded.
    """

    channel: Channel
    data: bytes
    time: float


class ChannelClosed(NamedTuple):
    """A peer is gone; writing to its channel raises from now on."""

    channel: Channel
    reason: str


class LinkDown(NamedTuple):
    """The link has no peer and tries to connect again in `retry_in` seconds."""

    reason: str
    retry_in: float


LinkEvent: TypeAlias = ChannelOpened | BytesReceived | ChannelClosed | LinkDown
