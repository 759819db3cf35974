"""Dispatch of packets and events to listeners and subscriptions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.node.api_object import ApiObject
from mavstack.node.subscription import Subscription
from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.dialects import Message
    from mavstack.services import Service
    from mavstack.wire import Packet

#: The message id of listeners to all messages.
ANY = -1
#: Maximum number of cached lookups: without a bound, forged ids and addresses could fill the memory.
MAX_CACHED = 16384


class Listener(ApiObject):
    """A callback that is called with each packet of its message classes, until `close`."""

    __slots__ = ("_dispatch", "deliver", "ids", "source")

    def __init__(
        self,
        dispatch: PacketDispatch,
        ids: tuple[int, ...],
        source: Address,
        deliver: Callable[[Packet], None],
    ) -> None:
        self._dispatch = dispatch
        self.ids = ids
        self.source = source
        self.deliver = deliver

    def close(self) -> None:
        """Unregister the callback. Idempotent."""
        self._dispatch.remove(self)


class PacketDispatch:
    """The packet listeners, by message id and system; each lookup by id and source is cached."""

    def __init__(self) -> None:
        self._by_key: dict[tuple[int, int], list[Listener]] = {}  # key: message id, system (0: all)
        self._cache: dict[tuple[int, int, int], tuple[Listener, ...]] = {}
        self._open: dict[Subscription[Any], Listener] = {}
        #: Called after a change of listeners: message ids (`ANY`: all), and their system (0: all).
        self.on_change: Callable[[tuple[int, ...], int], None] = lambda ids, system: None

    def add(
        self, kinds: Iterable[type[Message]], source: Address, deliver: Callable[[Packet], None]
    ) -> Listener:
        """Register a callback for the packets of these message classes (none: all) from a source (0: any)."""
        ids = tuple({kind.__mavlink_row__[0] for kind in kinds}) or (ANY,)
        listener = Listener(self, ids, source, deliver)
        self._cache.clear()
        for message_id in ids:
            self._by_key.setdefault((message_id, source.system), []).append(listener)
        self.on_change(ids, source.system)
        return listener

    def subscribe(
        self,
        kinds: Iterable[type[Message]],
        source: Address,
        convert: Callable[[Packet], Any],
        *,
        queue: int,
        keep_all: bool,
    ) -> Subscription[Any]:
        """Subscribe to these message classes (none: all); `convert` returns the item of a packet."""
        subscription: Subscription[Any] = Subscription(self._unsubscribe, queue=queue, keep_all=keep_all)
        put = subscription.put
        self._open[subscription] = self.add(kinds, source, lambda packet: put(convert(packet)))
        return subscription

    def subscribe_to_all(self, source: Address, *, queue: int, keep_all: bool) -> Subscription[Any]:
        """Subscribe to every message that the dialect defines."""
        subscription: Subscription[Any] = Subscription(self._unsubscribe, queue=queue, keep_all=keep_all)

        def deliver(packet: Packet) -> None:
            if packet.message is not None:
                subscription.put(packet.message)

        self._open[subscription] = self.add((), source, deliver)
        return subscription

    def deliver(self, packet: Packet) -> None:
        """Deliver a packet to its listeners."""
        key = packet.message_id, packet.system, packet.component
        cached = self._cache.get(key)
        for listener in self._find(*key) if cached is None else cached:
            listener.deliver(packet)

    def end(self) -> None:
        """End all subscriptions."""
        for subscription in tuple(self._open):
            subscription.end()

    def remove(self, listener: Listener) -> None:
        """Unregister a listener. Idempotent."""
        self._cache.clear()
        for message_id in listener.ids:
            listeners = self._by_key[message_id, listener.source.system]
            if listener in listeners:
                listeners.remove(listener)
        self.on_change(listener.ids, listener.source.system)

    def functions(self, message_id: int, source: tuple[int, int]) -> tuple[Callable[[Packet], None], ...]:
        """Return the functions of the listeners to a message of a source."""
        return tuple(listener.deliver for listener in self._find(message_id, *source))

    def functions_for(self, packet: Packet) -> tuple[Callable[[Packet], None], ...]:
        """Return the functions of the listeners to a packet."""
        return self.functions(packet.message_id, (packet.system, packet.component))

    def _find(self, message_id: int, system: int, component: int) -> tuple[Listener, ...]:
        if len(self._cache) >= MAX_CACHED:
            self._cache.clear()
        source = Address(system, component)
        # Listeners to all messages come first: they update state that the other listeners read.
        keys = [(kind, each) for kind in (ANY, message_id) for each in ((0, system) if system else (0,))]
        candidates = [listener for key in keys for listener in self._by_key.get(key, ())]
        found = tuple(listener for listener in candidates if listener.source.covers(source))
        self._cache[message_id, system, component] = found
        return found

    def _unsubscribe(self, subscription: Subscription[Any]) -> None:
        self._open.pop(subscription).close()


class EventDispatch:
    """The subscriptions to events, by event class and service."""

    def __init__(self) -> None:
        self._open: dict[Subscription[Any], tuple[tuple[type, ...], Service | None]] = {}

    def subscribe(self, kinds: tuple[type, ...], service: Service | None, *, queue: int) -> Subscription[Any]:
        """Subscribe to events of these classes (none: all), of one service (None: of all)."""
        subscription: Subscription[Any] = Subscription(self._remove, queue=queue)
        self._open[subscription] = (kinds or (object,), service)
        return subscription

    def deliver(self, event: object, service: Service | None = None) -> None:
        """Deliver an event to its subscriptions."""
        for subscription, (kinds, source) in tuple(self._open.items()):
            if isinstance(event, kinds) and source in (None, service):
                subscription.put(event)

    def end(self) -> None:
        """End all subscriptions."""
        for subscription in tuple(self._open):
            subscription.end()

    def _remove(self, subscription: Subscription[Any]) -> None:
        del self._open[subscription]
