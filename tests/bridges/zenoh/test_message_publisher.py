from __future__ import annotations

import json
from math import nan
from typing import Any

from mavstack import Parser, encode
from mavstack.bridges.zenoh.keys import VehicleKeys
from mavstack.bridges.zenoh.message_publisher import MessagePublishers, message_json
from mavstack.dialects import Dialect, Message, common


def packet(message: Message) -> Any:
    (found,) = Parser(Dialect.load("all")).feed(encode(message, system=7, component=1, sequence=3))
    return found


class FakeBus:
    """Publishers by their keys; all samples in one list."""

    def __init__(self) -> None:
        self.matching: dict[str, Any] = {}
        self.samples: list[tuple[str, bytes]] = []
        self.withdrawn = 0

    def publisher(self, key: str, matching: Any) -> Any:
        self.matching[key] = matching
        return FakePublisher(self, key)

    def undeclare(self, declared: Any) -> None:
        self.withdrawn += 1


class FakePublisher:
    def __init__(self, bus: FakeBus, key: str) -> None:
        self.bus, self.key = bus, key

    def put(self, data: bytes, encoding: str) -> None:
        assert encoding == "application/json"
        self.bus.samples.append((self.key, data))


def test_a_message_is_strict_json() -> None:
    found = json.loads(message_json(packet(common.Attitude(roll=0.5, pitch=nan)), 12.5), parse_constant=None)
    assert (found["message"], found["system"], found["component"], found["time"]) == ("ATTITUDE", 7, 1, 12.5)
    assert (found["fields"]["roll"], found["fields"]["pitch"]) == (0.5, None)


def test_keys_are_hidden() -> None:
    found = json.loads(message_json(packet(common.SetupSigning(secret_key=tuple(range(32)))), 0.0))
    assert found["fields"]["secret_key"] == "(hidden)"


def test_only_messages_with_subscribers_are_converted() -> None:
    bus: Any = FakeBus()
    publishers = MessagePublishers(bus, VehicleKeys("mavstack", "alpha"))
    publishers.publish(packet(common.Attitude()))
    publishers.publish(packet(common.Heartbeat()))
    assert bus.samples == []
    bus.matching["mavstack/alpha/message/1/ATTITUDE"](True)
    publishers.publish(packet(common.Attitude()))
    publishers.publish(packet(common.Heartbeat()))
    assert [key for key, _ in bus.samples] == ["mavstack/alpha/message/1/ATTITUDE"]
    publishers.close()
    assert bus.withdrawn == 2
