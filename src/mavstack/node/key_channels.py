"""The channels that a signing key may be sent over: SETUP_SIGNING carries the key in the clear.

A key goes over channels on which signed packets of the target were verified. For a first key there is none,
so the program names a channel that no other program can hear. While the key is set up, everything for the
target goes over the named channel, and what arrives over other channels proves nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.node.channel_state import ChannelState
    from mavstack.node.chosen_senders import ChosenSenders
    from mavstack.node.routes import Routes
    from mavstack.services import Address


class KeyChannels:
    """The channels of an engine, with those that were named for the first key of a target."""

    def __init__(
        self, routes: Routes[ChannelState], channels: Sequence[ChannelState], senders: ChosenSenders
    ) -> None:
        self._routes = routes
        self._senders = senders
        self._channels = channels
        self._named: dict[Address, str] = {}

    def name(self, target: Address, name: str) -> None:
        """Name the channel for a target's first key.

        Raises:
            InvalidArgumentError: There is no open channel of that name.
        """
        names = [channel.name for channel in self._channels]
        if name not in names:
            known = ", ".join(names) or "none"
            raise InvalidArgumentError(f"no open channel is named {name!r}; open channels: {known}")
        self._named[target] = name

    def release(self, target: Address) -> None:
        """Forget the channel that was named for a target. Idempotent."""
        self._named.pop(target, None)

    def refusal(self, target: Address) -> str | None:
        """Return the reason why a signing key may not be sent to a target now; None if it may."""
        channels, named = self.leading_to(target), self._named.get(target)
        verified = self._routes.verified_on(target)
        unsafe = [each.name for each in channels if each.name != named and each not in verified]
        if channels and not unsafe:
            return None
        over = " and ".join(unsafe) or "any channel"
        example = unsafe[0] if unsafe else "NAME"
        return (
            f"it was not verified over {over}, and the key is sent in the clear; "
            f"name a channel that no other program can hear: channel={example!r}"
        )

    def is_other(self, target: Address, channel: ChannelState | None) -> bool:
        """Return whether a channel is not the open one that was named for the target's key."""
        named = self._named.get(target)
        if named is None or channel is None or channel.name == named:
            return False
        return any(each.name == named for each in self._channels)

    def named(self, name: str) -> Sequence[ChannelState]:
        """Return the open channel of a name, in a list; empty if there is none."""
        return [channel for channel in self._channels if channel.name == name]

    def leading_to(self, target: Address, name: str = "") -> Sequence[ChannelState]:
        """Return the channels that lead to a target: the one named for its key or chosen, or its route's.

        With a name it is the channel of that name alone.
        """
        if name:
            return self.named(name)
        if self._named and (key_channel := self._named.get(target)) is not None:
            named = self.named(key_channel)
            if named:
                return named
        if self._senders.is_limited and (chosen := self._senders.channels_to(target)) is not None:
            return chosen
        return self._routes.channels_to(target, self._channels)
