"""The messages of one name as server-sent events: the same JSON and limits as over a WebSocket."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.server.client_queue import ClientQueue, stream_texts
from mavstack.server.json_client import MAX_QUEUE

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.server.observer_lane import ObserverLane
    from mavstack.server.packet_hub import Batch, PacketHub
    from mavstack.server.subscriptions import Subscriptions


class MessageStream:
    """A client of the hub that reads by HTTP.

    Args:
        subscriptions: The messages of the stream.
        count: Events after which it ends; None: it has no end.
        lane: The lane in which it waits for its turn before each event; None: it does not wait.
    """

    def __init__(
        self, subscriptions: Subscriptions, count: int | None = None, lane: ObserverLane | None = None
    ) -> None:
        self._lane = lane
        self.queue: ClientQueue[str] = ClientQueue(MAX_QUEUE)
        self._subscriptions = subscriptions
        self._count = count

    def put(self, batch: Batch) -> None:
        """Queue the messages of a batch that belong to the stream."""
        for index, (packet, time) in enumerate(batch.packets):
            if self._subscriptions.wants(packet, time):
                self.queue.put(batch.text(index))

    async def events(self, hub: PacketHub) -> AsyncIterator[str]:
        """Yield server-sent events until the client leaves."""
        hub.clients.add(self)
        sent = 0
        try:
            async for text in stream_texts(self.queue):
                if self._lane is not None:
                    await self._lane.turn()
                yield f"data: {text}\n\n"
                sent += 1
                if sent == self._count:
                    return
        finally:
            hub.clients.discard(self)
