"""A session with a broker in memory: what was published, and messages to the vehicle."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from mavstack.bridges.mqtt.broker import Arrived

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.bridges.mqtt.broker import Broker


class MemorySession:
    """Takes the place of `Session`."""

    def __init__(
        self,
        broker: Broker,
        will: str = "",
        subscriptions: Sequence[str] = (),
        *,
        connected: Callable[[], object] = lambda: None,
        take: Callable[[Arrived], object] = lambda message: None,
    ) -> None:
        self.will = will
        self.subscriptions = list(subscriptions)
        self.published: list[tuple[str, bytes, int, bool, bytes]] = []
        self.connected = connected
        self.is_open = False
        self.dropped = 0
        self._take = take

    async def open(self) -> None:
        self.is_open = True
        self.connected()

    async def close(self) -> None:
        self.is_open = False

    def publish(
        self, topic: str, payload: bytes, *, qos: int = 0, retain: bool = False, correlation: bytes = b""
    ) -> bool:
        self.published.append((topic, payload, qos, retain, correlation))
        return True

    def arrive(self, topic: str, payload: bytes = b"", **properties: Any) -> None:
        self._take(Arrived(topic, payload, **properties))

    def all(self, topic: str) -> list[Any]:
        """The payloads of a topic; JSON where they are."""
        return [_decoded(payload) for name, payload, *_ in self.published if name == topic]


def _decoded(payload: bytes) -> Any:
    try:
        return json.loads(payload)
    except ValueError:
        return payload.decode()
