"""From packets and events to the subscriptions that asked for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.node.subscription import Subscription

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.dialects import Message
    from mavstack.services import Address, Service
    from mavstack.wire import Packet

#: Stands for "every message" in the register.
ANY = -1


class Listening:
    """A function that is called with each packet it asked for, until `close`."""

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

    def hears(self, packet: Packet) -> bool:
        """Whether the packet comes from whom it listens to."""
        system, component = self.source
        return system in (0, packet.system) and component in (0, packet.component)

    def close(self) -> None:
        """Be called no more. Closing twice does nothing."""
        self._dispatch.forget(self)


class PacketDispatch:
    """Who listens to which packets, by message id."""

    def __init__(self) -> None:
        self._by_id: dict[int, list[Listening]] = {}
        self._open: dict[Subscription[Any], Listening] = {}

    def listen(
        self, kinds: Iterable[type[Message]], source: Address, deliver: Callable[[Packet], None]
    ) -> Listening:
        """Have a function called with the packets of these classes (none: all)."""
        ids = tuple({kind.__mavlink_row__[0] for kind in kinds}) or (ANY,)
        listening = Listening(self, ids, source, deliver)
        for message_id in ids:
            self._by_id.setdefault(message_id, []).append(listening)
        return listening

    def subscribe(
        self,
        kinds: Iterable[type[Message]],
        source: Address,
        form: Callable[[Packet], Any],
        *,
        queue: int,
        keep_all: bool,
    ) -> Subscription[Any]:
        """A subscription to messages of these classes (none: all), in the form that `form` gives a packet."""
        subscription: Subscription[Any] = Subscription(self._unsubscribe, queue=queue, keep_all=keep_all)
        put = subscription.put
        self._open[subscription] = self.listen(kinds, source, lambda packet: put(form(packet)))
        return subscription

    def deliver(self, packet: Packet) -> None:
        """Hand a packet to all who listen."""
        for listening in (*self._by_id.get(packet.message_id, ()), *self._by_id.get(ANY, ())):
            if listening.hears(packet):
                listening.deliver(packet)

    def end(self) -> None:
        """No more will come."""
        for subscription in tuple(self._open):
            subscription.end()

    def forget(self, listening: Listening) -> None:
        """It listens no more."""
        for message_id in listening.ids:
            listeners = self._by_id[message_id]
            if listening in listeners:
                listeners.remove(listening)

    def _unsubscribe(self, subscription: Subscription[Any]) -> None:
        self._open.pop(subscription).close()


class EventDispatch:
    """Subscriptions to events by their classes."""

    def __init__(self) -> None:
        self._open: dict[Subscription[Any], tuple[tuple[type, ...], Service | None]] = {}

    def subscribe(self, kinds: tuple[type, ...], service: Service | None, *, queue: int) -> Subscription[Any]:
        """A subscription to events of these classes (none: all), of one service (none: of whatever)."""
        subscription: Subscription[Any] = Subscription(self._forget, queue=queue)
        self._open[subscription] = (kinds or (object,), service)
        return subscription

    def deliver(self, event: object, service: Service | None = None) -> None:
        """Hand an event to all who listen."""
        for subscription, (kinds, wanted) in tuple(self._open.items()):
            if isinstance(event, kinds) and wanted in (None, service):
                subscription.put(event)

    def end(self) -> None:
        """No more will come."""
        for subscription in tuple(self._open):
            subscription.end()

    def _forget(self, subscription: Subscription[Any]) -> None:
        del self._open[subscription]
