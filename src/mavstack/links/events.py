"""The events of a link.

Each `ChannelOpened` is followed by exactly one `ChannelClosed` of the same channel, and all `BytesReceived`
of a channel come between the two. Events are plain tuples, because each datagram is one event.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

if TYPE_CHECKING:
    from mavstack.links.channel import Channel


class ChannelOpened(NamedTuple):
    """A channel to a new peer opened."""

    channel: Channel


class BytesReceived(NamedTuple):
    """Received bytes: one datagram (several with `Link.joins_datagrams`), or a chunk of a stream.

    `time` is the Unix time of reception in seconds, or in a replay the time of recording.
    """

    channel: Channel
    data: bytes
    time: float


class ChannelClosed(NamedTuple):
    """A channel closed; writing to it raises `LinkClosedError`."""

    channel: Channel
    reason: str


class LinkDown(NamedTuple):
    """The link has no connection; the next attempt is in `retry_in` seconds."""

    reason: str
    retry_in: float


LinkEvent: TypeAlias = ChannelOpened | BytesReceived | ChannelClosed | LinkDown
