"""A sink in memory, which subscribes to all topics or to named ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.bridges.core.types import codec_of

if TYPE_CHECKING:
    from mavstack.bridges.core.endpoints import Inlet, ServiceEndpoint
    from mavstack.bridges.core.topic import Topic


class MemorySink:
    """The endpoints of a bridge by name, and the samples of the subscribed topics."""

    def __init__(self, *subscribed: str) -> None:
        self.nodes: list[str] = []
        self.topics: dict[str, Topic] = {}
        self.inlets: dict[str, Inlet] = {}
        self.services: dict[str, ServiceEndpoint] = {}
        self.samples: dict[str, list[tuple[bytes, int]]] = {}
        self._subscribed = subscribed
        self.is_open = False

    async def open(self) -> None:
        self.is_open = True

    async def close(self) -> None:
        self.is_open = False

    def add_node(self, namespace: str, name: str) -> None:
        self.nodes.append(f"{namespace}/{name}")

    def add_topic(self, topic: Topic) -> None:
        self.topics[topic.name] = topic
        if not self._subscribed or topic.name in self._subscribed:
            self.subscribe(topic.name)

    def subscribe(self, name: str) -> None:
        samples = self.samples.setdefault(name, [])
        self.topics[name].add_receiver(lambda payload, stamp: samples.append((payload, stamp)))

    def add_inlet(self, inlet: Inlet) -> None:
        self.inlets[inlet.name] = inlet

    def add_service(self, service: ServiceEndpoint) -> None:
        self.services[service.name] = service

    def last(self, name: str) -> dict[str, Any]:
        """Return the fields of the last sample of a topic."""
        return codec_of(self.topics[name].type).decode_fields(self.samples[name][-1][0])

    async def call(self, name: str, **request: Any) -> dict[str, Any]:
        """Call a service by CDR."""
        service = self.services[name]
        payload = codec_of(f"{service.type}_Request").encode_fields(request)
        return codec_of(f"{service.type}_Response").decode_fields(await service.call(payload))
