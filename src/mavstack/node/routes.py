"""Routes: the channel that leads to each address, learned from every packet.

Heartbeats alone do not suffice, since some sources never send one. The preferred channel of an address does
not change while the address is heard on it, so that two links to one vehicle do not alternate. A packet to
an address that was never heard goes over the channels of its system, and if the system is unknown, over all
channels. Some programs send as component 0; a packet to component 0 is for all components of its system.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Sequence

Channel = TypeVar("Channel")

#: Seconds of silence after which another channel that hears the address becomes the preferred one.
SILENCE_TIMEOUT = 2.5
#: Addresses in the table; a flood of forged ones removes those learned first.
MAX_ADDRESSES = 4096


class _Route(Generic[Channel]):
    __slots__ = ("heard", "preferred")

    def __init__(self, channel: Channel, now: float) -> None:
        self.preferred = channel
        self.heard: dict[Channel, float] = {channel: now}

    def learn(self, channel: Channel, now: float) -> bool:
        """Record that the address was heard; return whether it is heard on several channels."""
        heard = self.heard
        heard[channel] = now
        if len(heard) == 1:
            return False
        if (
            channel is not self.preferred
            and now - heard.get(self.preferred, -SILENCE_TIMEOUT) >= SILENCE_TIMEOUT
        ):
            self.preferred = channel
        return True

    def remove_channel(self, channel: Channel) -> bool:
        """Remove a channel; return whether none is left."""
        self.heard.pop(channel, None)
        if self.heard and self.preferred is channel:
            self.preferred = max(self.heard, key=lambda known: self.heard[known])
        return not self.heard


class Routes(Generic[Channel]):
    """The channels on which each address was heard."""

    def __init__(self) -> None:
        self._routes: dict[Address, _Route[Channel]] = {}
        self._systems: dict[int, dict[Address, _Route[Channel]]] = {}

    def learn(self, heard: tuple[int, int], channel: Channel, now: float) -> bool:
        """Record that an address was heard on a channel; return whether it is heard on several.

        System 0 is the broadcast address and is not recorded.
        """
        # An address equals a plain tuple, which is created in half the time.
        route: _Route[Channel] | None = self._routes.get(heard)  # type: ignore[call-overload]
        if route is not None:
            return route.learn(channel, now)
        address = Address(*heard)
        if address.system:
            self._make_room()
            self._routes[address] = route = _Route(channel, now)
            self._systems.setdefault(address.system, {})[address] = route
        return False

    def channels_to(self, target: Address, channels: Sequence[Channel]) -> Sequence[Channel]:
        """Return those of the open channels that lead to a target."""
        if target.system == 0:
            return channels
        route = self._routes.get(target) if target.component else None
        if route is not None:
            return (route.preferred,)
        known = self._systems.get(target.system)
        if not known:
            return channels
        found = {route.preferred: None for route in known.values()}
        return [channel for channel in channels if channel in found]

    def heard_on(self, address: Address) -> tuple[Channel, ...]:
        """Return the channels on which an address was heard."""
        route = self._routes.get(address)
        return tuple(route.heard) if route else ()

    def remove_channel(self, channel: Channel) -> None:
        """Remove a closed channel."""
        for address in [key for key, route in self._routes.items() if route.remove_channel(channel)]:
            self._remove(address)

    def _remove(self, address: Address) -> None:
        del self._routes[address]
        system = self._systems[address.system]
        del system[address]
        if not system:
            del self._systems[address.system]

    def _make_room(self) -> None:
        if len(self._routes) >= MAX_ADDRESSES:
            self._remove(next(iter(self._routes)))
