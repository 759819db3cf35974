"""Changing a channel's key while it is in use: what services ask for is done to the channels of a peer.

While a change is open a channel has two signing states and signs with the first; it accepts what either
accepts. Swapping keeps both as they are, timestamps and half a packet included.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services import message_ids
from mavstack.services.signing_setup import KeyEvent, KeySettled, ListenForKey, UseNewKey, UseOldKey

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.node.channel_state import ChannelState
    from mavstack.node.engine import Engine
    from mavstack.security import SigningKey
    from mavstack.services.signing_setup import SigningRequest
    from mavstack.wire import Signing

#: Radios send it themselves and have no key.
UNSIGNED = tuple(message_ids(common.RadioStatus))


def apply_key_event(event: KeyEvent, channels: Iterable[ChannelState]) -> None:
    """Do to the channels what a service asks for."""
    for channel in channels:
        match event:
            case ListenForKey(key=key, timestamp=timestamp):
                channel.listen_also(signing_of(key, channel, timestamp))
            case UseNewKey():
                channel.use_new(True)
            case UseOldKey():
                channel.use_new(False)
            case KeySettled():
                channel.settle()


def trusted_channels(engine: Engine) -> Callable[[SigningRequest], str | None]:
    """The policy that lets keys be set over the channels that the program marked as `trusted`."""

    def may_set(request: SigningRequest) -> str | None:
        channel = engine.arrived_on
        return None if channel is not None and channel.trusted else "this link is not trusted"

    return may_set


def signing_of(key: SigningKey | None, channel: ChannelState, timestamp: int) -> Signing | None:
    """A signing state for a channel, none without a key; its clock goes on from the channel's, or later."""
    if key is None:
        return None
    return key.signing(channel.link_id, timestamp=max(timestamp, channel.clock), unsigned_ids=UNSIGNED)
