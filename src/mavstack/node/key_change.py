"""Changes of a channel's signing key while the channel is in use.

The events of the signing services are applied to the channels on which a peer is heard. During a change, a
channel has two signing states: it signs with the first, and accepts packets of either. Switching between them
keeps both, with their timestamps and half-received packets.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from mavstack.dialects import common
from mavstack.services.signing_setup import KeyEvent, KeySettled, ListenForKey, UseNewKey, UseOldKey

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.dialects import Message
    from mavstack.node.channel_state import ChannelState
    from mavstack.node.signing_states import SigningStates
    from mavstack.services.signing_setup import SigningRequest


def apply_key_event(event: KeyEvent, channels: Iterable[ChannelState], states: SigningStates) -> None:
    """Apply an event of a signing service to channels; `states` has the signing states of the node's keys."""
    for channel in channels:
        match event:
            case ListenForKey(key=key, timestamp=timestamp):
                channel.accept_also(states.create(key, channel.link_id, max(timestamp, channel.clock)))
            case UseNewKey():
                channel.use_new(True)
            case UseOldKey():
                channel.use_new(False)
            case KeySettled():
                channel.settle()


def carries_key(message: Message) -> bool:
    """Return whether a message carries a signing key; SETUP_SIGNING with zeros turns signing off."""
    return isinstance(message, common.SetupSigning) and any(message.secret_key)


class ArrivalChannel(Protocol):
    """The part of an engine that a policy needs: the channel of the packet that is being handled."""

    @property
    def arrived_on(self) -> ChannelState | None:
        """The channel of the packet that is being handled; None in between."""


def trusted_channels(engine: ArrivalChannel) -> Callable[[SigningRequest], str | None]:
    """Return the policy that accepts keys only over channels that the program marked as `trusted`."""

    def refuse(request: SigningRequest) -> str | None:
        channel = engine.arrived_on
        return None if channel is not None and channel.trusted else "this link is not trusted"

    return refuse
