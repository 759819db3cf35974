"""The streams of a bridge: polled MSP messages in, MAVLink messages at requested intervals out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.bridges.msp.samples import Samples
    from mavstack.bridges.msp.telemetry import StreamedMessage
    from mavstack.msp.messages.base import MspMessage
    from mavstack.node import Node
    from mavstack.services.message_request.server import Made, Producer

#: Seconds between two polls of a message that no client streams and that is only requested.
REQUEST_INTERVAL: Final = 2.0
#: Minimum interval of a poll in seconds, even if a client requests a shorter one.
MIN_INTERVAL: Final = 0.005


class Streams:
    """The streams of one flight controller.

    Args:
        node: The node of the bridge, whose message server sends the streams.
        samples: The latest MSP messages.
    """

    def __init__(self, node: Node, samples: Samples) -> None:
        self._node, self._samples = node, samples
        self._streamed: list[StreamedMessage] = []
        self._fixed: dict[type[MspMessage], float] = {}

    def add(self, messages: Iterable[StreamedMessage]) -> None:
        """Publish messages."""
        for each in messages:
            self._streamed.append(each)
            server = self._node.message_server
            server.provide(each.message, self._producer(each.produce), interval=each.interval, triggered=True)

    def poll(self, kind: type[MspMessage], interval: float) -> None:
        """Poll a message at an interval in seconds at least, whatever is streamed."""
        self._fixed[kind] = interval

    def intervals(self) -> dict[type[MspMessage], float]:
        """Return the messages to poll, and their intervals in seconds."""
        found = dict(self._fixed)
        for each in self._streamed:
            microseconds = self._node.message_server.interval_of(each.message)
            interval = max(microseconds / 1e6, MIN_INTERVAL) if microseconds > 0 else REQUEST_INTERVAL
            for source in each.sources:
                found[source] = min(found.get(source, interval), interval)
        return found

    def receive(self, message: MspMessage) -> None:
        """Store a polled message, and send the MAVLink messages that it completes."""
        now = self._node.now()
        self._samples.put(message, now)
        server, kind = self._node.message_server, type(message)
        for each in self._streamed:
            if each.sources[0] is kind:
                server.trigger(each.message, now)
        self._node.wake(server)

    def _producer(self, produce: Callable[[], Made]) -> Producer:
        def make(now: float) -> Made:
            self._samples.now = now
            return produce()

        return make
