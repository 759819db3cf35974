"""Routes: the channel that leads to each address, learned from every packet.

Heartbeats alone do not suffice, since some sources never send one. The preferred channel of an address does
not change while the address is heard on it, so that two links to one vehicle do not alternate. A packet to
an address that was never heard goes over the channels of its system, and if the system is unknown, over all
channels. Some programs send as component 0; a packet to component 0 is for all components of its system.

A channel that verifies signatures teaches verified routes. An address with a verified route has no others:
what an unsigned channel receives from it is forged, or a copy. The table is bounded. If it is full, addresses
that were heard only once are removed first, then silent ones, and verified ones last. Only some addresses may
have more than a few channels; the others keep their preferred, verified and newest ones.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

Channel = TypeVar("Channel")

#: Seconds without a packet on the preferred channel after which another channel replaces it.
SILENCE_TIMEOUT = 2.5
#: Maximum number of addresses in the table, and number of addresses that are removed when it is full.
MAX_ADDRESSES = 4096
REMOVED_AT_ONCE = 512
#: Maximum number of channels of an address; the last `MAX_WIDE` addresses that exceeded it may have more.
MAX_CHANNELS = 4
MAX_WIDE = 64
#: Minimum seconds between the first and the last packet of an address that is not removed first.
MIN_HEARD_DURATION = 1.0


class _Route(Generic[Channel]):
    __slots__ = ("began_at", "heard", "preferred", "verified")

    def __init__(self, channel: Channel, now: float) -> None:
        self.preferred = channel
        self.heard: dict[Channel, float] = {channel: now}
        #: The channels on which a signed packet of the address has been verified.
        self.verified: set[Channel] = set()
        self.began_at = now

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

    def narrow(self) -> None:
        """Keep only `MAX_CHANNELS` channels."""
        order = sorted(
            self.heard,
            key=lambda known: (known is self.preferred, known in self.verified, self.heard[known]),
        )
        for channel in order[:-MAX_CHANNELS]:
            del self.heard[channel]
            self.verified.discard(channel)

    def verify(self, channel: Channel) -> None:
        """Record that the address was verified on a channel; forget the channels on which it was not."""
        self.verified.add(channel)
        self.heard = {known: at for known, at in self.heard.items() if known in self.verified}
        if self.preferred not in self.verified:
            self.preferred = channel

    def removal_order(self) -> tuple[bool, bool, float]:
        """Return a key that sorts the routes to remove first to the front."""
        heard_at = max(self.heard.values(), default=self.began_at)
        return bool(self.verified), heard_at - self.began_at >= MIN_HEARD_DURATION, heard_at

    def remove_channel(self, channel: Channel) -> bool:
        """Remove a channel; return whether none is left."""
        self.verified.discard(channel)
        self.heard.pop(channel, None)
        if self.heard and self.preferred is channel:
            self.preferred = max(self.heard, key=lambda known: self.heard[known])
        return not self.heard


class Routes(Generic[Channel]):
    """The channels on which each address was heard."""

    def __init__(self) -> None:
        self._routes: dict[Address, _Route[Channel]] = {}
        self._systems: dict[int, dict[Address, _Route[Channel]]] = {}
        self._verified: set[tuple[int, int]] = set()
        self._wide: dict[tuple[int, int], None] = {}
        #: Called before an address gets a further channel, or is verified on a channel for the first time.
        self.before_change: Callable[[tuple[int, int]], None] = lambda address: None
        #: Called before addresses are removed because the table is full.
        self.before_removal: Callable[[], None] = lambda: None

    def learn(self, heard: tuple[int, int], channel: Channel, now: float, *, verified: bool = False) -> bool:
        """Record that an address was heard on a channel; return whether it is heard on several.

        System 0 is the broadcast address and is not recorded.
        """
        # `heard` is a plain tuple: it equals the Address of the same ids, and is created in half the time.
        route: _Route[Channel] | None = self._routes.get(heard)  # type: ignore[call-overload]
        if route is not None:
            if channel not in route.heard or (verified and channel not in route.verified):
                self.before_change(heard)
            if verified and channel not in route.verified:
                self._verified.add(heard)
                route.verify(channel)
            is_redundant = route.learn(channel, now)
            if is_redundant and len(route.heard) > MAX_CHANNELS and heard not in self._wide:
                self._widen(heard)
            return is_redundant
        address = Address(*heard)
        if address.system:
            self._make_room()
            self._routes[address] = route = _Route(channel, now)
            self._systems.setdefault(address.system, {})[address] = route
            if verified:
                self._verified.add(address)
                route.verify(channel)
        return False

    def note_heard(self, heard: tuple[int, int], channel: Channel, at: float) -> None:
        """Record that an address was heard on a channel on which it is known, in time order or not."""
        route: _Route[Channel] | None = self._routes.get(heard)  # type: ignore[call-overload]
        if route is not None and route.heard.get(channel, at) < at:
            route.heard[channel] = at

    def is_heard_only_on(self, heard: tuple[int, int], channel: Channel) -> bool:
        """Return whether an address is heard on one channel alone."""
        route: _Route[Channel] | None = self._routes.get(heard)  # type: ignore[call-overload]
        return route is not None and len(route.heard) == 1 and channel in route.heard

    def is_verified(self, heard: tuple[int, int]) -> bool:
        """Return whether an address was verified on an open channel."""
        return bool(self._verified) and heard in self._verified

    def knows_system(self, system: int) -> bool:
        """Return whether any address of a system is known."""
        return system in self._systems

    def verified_on(self, address: Address) -> frozenset[Channel]:
        """Return the channels on which an address was verified."""
        route = self._routes.get(address)
        return frozenset(route.verified) if route else frozenset()

    def unverify(self, channel: Channel) -> None:
        """Forget what was verified on a channel whose signing is turned off."""
        for address, route in self._routes.items():
            route.verified.discard(channel)
            if not route.verified:
                self._verified.discard(address)

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
        found = {route.preferred: None for route in known.values() if route.verified}
        found = found or {route.preferred: None for route in known.values()}
        return [channel for channel in channels if channel in found]

    def all_channels_to(self, target: Address, channels: Sequence[Channel]) -> Sequence[Channel]:
        """Return the open channels on which a target was heard, for packets of other components.

        They are the router's choice: every channel that heard the target or, if only its system is known,
        that system; none for an unknown system.
        """
        if target.system == 0:
            return channels
        exact = self._routes.get(target) if target.component else None
        known = [exact] if exact is not None else list(self._systems.get(target.system, {}).values())
        verified = {channel: None for route in known for channel in route.verified}
        found = verified or {channel: None for route in known for channel in route.heard}
        return [channel for channel in channels if channel in found]

    def heard_on(self, address: Address) -> tuple[Channel, ...]:
        """Return the channels on which an address was heard."""
        route = self._routes.get(address)
        return tuple(route.heard) if route else ()

    def remove_channel(self, channel: Channel) -> None:
        """Remove a closed channel."""
        for address in [key for key, route in self._routes.items() if route.remove_channel(channel)]:
            self._remove(address)
        self._verified = {address for address in self._verified if self._routes[Address(*address)].verified}

    def _remove(self, address: Address) -> None:
        del self._routes[address]
        self._verified.discard(address)
        self._wide.pop(address, None)
        system = self._systems[address.system]
        del system[address]
        if not system:
            del self._systems[address.system]

    def _widen(self, address: tuple[int, int]) -> None:
        """Let an address have many channels; too many of such addresses lose the first one."""
        self._wide[address] = None
        if len(self._wide) > MAX_WIDE:
            first = next(iter(self._wide))
            del self._wide[first]
            self._routes[Address(*first)].narrow()

    def _make_room(self) -> None:
        if len(self._routes) >= MAX_ADDRESSES:
            self.before_removal()
            routes = self._routes
            for address in sorted(routes, key=lambda each: routes[each].removal_order())[:REMOVED_AT_ONCE]:
                self._remove(address)
