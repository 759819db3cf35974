"""Which channel leads to whom: learned from every packet, since some sources never send a heartbeat.

To an address leads the channel that it was last heard on; the choice stays as long as that channel is
alive, so that two links to one vehicle do not take turns. If an address was never heard, any channel that
heard its system will do, and if that was never heard either, all channels. Some programs send as component 0;
what is sent to it is for all components of their system.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Sequence

Channel = TypeVar("Channel")

#: After so many seconds of silence a channel gives way to another that still hears the address.
SILENCE = 2.5
#: So many addresses are remembered; a flood of forged ones pushes out those learned first.
MOST_ADDRESSES = 4096


class _Route(Generic[Channel]):
    __slots__ = ("heard", "preferred")

    def __init__(self, channel: Channel, now: float) -> None:
        self.preferred = channel
        self.heard: dict[Channel, float] = {channel: now}

    def learn(self, channel: Channel, now: float) -> bool:
        """It was heard; True if it is heard on more than one channel."""
        heard = self.heard
        heard[channel] = now
        if len(heard) == 1:
            return False
        if channel is not self.preferred and now - heard.get(self.preferred, -SILENCE) >= SILENCE:
            self.preferred = channel
        return True

    def forget(self, channel: Channel) -> bool:
        """Forget a channel; True if none is left."""
        self.heard.pop(channel, None)
        if self.heard and self.preferred is channel:
            self.preferred = max(self.heard, key=lambda known: self.heard[known])
        return not self.heard


class Routes(Generic[Channel]):
    """Where each address was heard, and which channels lead to it."""

    def __init__(self) -> None:
        self._routes: dict[Address, _Route[Channel]] = {}
        self._systems: dict[int, dict[Address, _Route[Channel]]] = {}

    def learn(self, heard: tuple[int, int], channel: Channel, now: float) -> bool:
        """An address was heard on the channel; True if it is heard on more than one. System 0 is nobody's."""
        # An address is equal to a tuple, which is made in half the time.
        route: _Route[Channel] | None = self._routes.get(heard)  # type: ignore[call-overload]
        if route is not None:
            return route.learn(channel, now)
        address = Address(*heard)
        if address.system:
            self._make_place()
            self._routes[address] = route = _Route(channel, now)
            self._systems.setdefault(address.system, {})[address] = route
        return False

    def channels_to(self, target: Address, channels: Sequence[Channel]) -> Sequence[Channel]:
        """The channels, of those open, that lead to the target."""
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
        """The channels on which the address was heard."""
        route = self._routes.get(address)
        return tuple(route.heard) if route else ()

    def forget(self, channel: Channel) -> None:
        """The channel is gone."""
        for address in [key for key, route in self._routes.items() if route.forget(channel)]:
            self._remove(address)

    def _remove(self, address: Address) -> None:
        del self._routes[address]
        system = self._systems[address.system]
        del system[address]
        if not system:
            del self._systems[address.system]

    def _make_place(self) -> None:
        if len(self._routes) >= MOST_ADDRESSES:
            self._remove(next(iter(self._routes)))
