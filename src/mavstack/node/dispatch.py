"""From packets and events to the subscriptions that asked for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.node.subscription import Subscription
from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.dialects import Message
    from mavstack.services import Service
    from mavstack.wire import Packet

#: Stands for "every message" in the register.
ANY = -1
#: So much of what was found is kept; ids and addresses can be forged.
MOST_FOUND = 16384


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

    def close(self) -> None:
        """Be called no more. Closing twice does nothing."""
        self._dispatch.forget(self)


class PacketDispatch:
    """Who listens to which packets, by message id and system; found once for each id and source heard."""

    def __init__(self) -> None:
        self._by_key: dict[tuple[int, int], list[Listening]] = {}  # message id, system (0: any)
        self._found: dict[tuple[int, int, int], tuple[Listening, ...]] = {}
        self._open: dict[Subscription[Any], Listening] = {}

    def listen(
        self, kinds: Iterable[type[Message]], source: Address, deliver: Callable[[Packet], None]
    ) -> Listening:
        """Have a function called with the packets of these classes (none: all)."""
        ids = tuple({kind.__mavlink_row__[0] for kind in kinds}) or (ANY,)
        listening = Listening(self, ids, source, deliver)
        self._found.clear()
        for message_id in ids:
            self._by_key.setdefault((message_id, source.system), []).append(listening)
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
        key = packet.message_id, packet.system, packet.component
        found = self._found.get(key)
        for listening in self._find(*key) if found is None else found:
            listening.deliver(packet)

    def end(self) -> None:
        """No more will come."""
        for subscription in tuple(self._open):
            subscription.end()

    def forget(self, listening: Listening) -> None:
        """It listens no more."""
        self._found.clear()
        for message_id in listening.ids:
            listeners = self._by_key[message_id, listening.source.system]
            if listening in listeners:
                listeners.remove(listening)

    def _find(self, message_id: int, system: int, component: int) -> tuple[Listening, ...]:
        if len(self._found) >= MOST_FOUND:
            self._found.clear()
        source = Address(system, component)
        # Who listens to everything goes first: what it keeps is there when the others are called.
        keys = [(kind, heard) for kind in (ANY, message_id) for heard in ((0, system) if system else (0,))]
        everyone = [listening for key in keys for listening in self._by_key.get(key, ())]
        found = tuple(listening for listening in everyone if listening.source.covers(source))
        self._found[message_id, system, component] = found
        return found

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
