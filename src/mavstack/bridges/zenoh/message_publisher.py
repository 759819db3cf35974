"""Messages of a vehicle by name as JSON: each key is converted while it has subscribers."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from mavstack.bridges.core.plain_json import json_bytes

if TYPE_CHECKING:
    from mavstack.bridges.zenoh.bus import Bus
    from mavstack.bridges.zenoh.keys import VehicleKeys
    from mavstack.wire import Packet


def message_json(packet: Packet, now: float) -> bytes:
    """Return a message as JSON: its name, the ids of its sender, the time of arrival, its fields.

    Fields have the names and the units of the definition; enums are numbers.
    """
    return json_bytes(
        {
            "message": packet.name,
            "system": packet.system,
            "component": packet.component,
            "time": now,
            "fields": packet.message.to_dict(enums="value"),
        }
    )


class MessagePublishers:
    """The publishers of one vehicle's messages, each made when its message first arrives."""

    def __init__(self, bus: Bus, keys: VehicleKeys) -> None:
        self._bus = bus
        self._keys = keys
        self._known: dict[tuple[int, int], _Publisher] = {}

    def publish(self, packet: Packet) -> None:
        """Publish the message of a packet if a client subscribes to it."""
        if packet.message is None:
            return
        key = packet.component, packet.message_id
        known = self._known.get(key)
        if known is None:
            known = self._known[key] = _Publisher(
                self._bus, self._keys.message(packet.component, str(packet.name))
            )
        if known.matching:
            known.put(message_json(packet, time.time()))

    def close(self) -> None:
        """Withdraw the publishers."""
        for each in self._known.values():
            each.close()
        self._known.clear()


class _Publisher:
    def __init__(self, bus: Bus, key: str) -> None:
        self.matching = False
        self._bus = bus
        self._declared: Any = bus.publisher(key, self._set_matching)

    def put(self, data: bytes) -> None:
        self._declared.put(data, encoding="application/json")

    def close(self) -> None:
        self._bus.undeclare(self._declared)

    def _set_matching(self, matching: bool) -> None:
        self.matching = matching
