from __future__ import annotations

import json

import pytest

from mavstack.dialects import Dialect, common
from mavstack.server import latest_messages
from mavstack.server.latest_messages import LatestMessages
from mavstack.server.message_json import latest_json
from mavstack.wire import Encoder, Packet

DIALECT = Dialect.load("common")


def packet(component=1, system=1, message=None) -> Packet:
    raw = Encoder(system, component).encode(message or common.Attitude(roll=0.5))
    return Packet(raw, DIALECT)


def test_counts_and_rates() -> None:
    latest = LatestMessages()
    for number in range(50):
        latest.store(packet(), 100 + number * 0.1)
    found = latest.find(1, 30)
    assert (found.count, found.rate(104.9)) == (50, pytest.approx(10))
    assert found.rate(120) == 0
    assert latest.find(2, 30) is latest.find(1, 31) is None


def test_of_several_components_the_last_one_is_shown() -> None:
    latest = LatestMessages()
    latest.store(packet(component=1), 100)
    latest.store(packet(component=100), 101)
    assert latest.find(1, 30).packet.component == 100
    assert latest.find(1, 30, component=1).packet.component == 1
    assert len(list(latest.of_system(1))) == 2


def test_the_number_of_messages_is_bounded(monkeypatch) -> None:
    monkeypatch.setattr(latest_messages, "MAX_MESSAGES", 8)
    latest = LatestMessages()
    for component in range(1, 30):
        latest.store(packet(component=component), component)
    kept = [each.packet.component for each in latest.of_system(1)]
    assert len(kept) <= 8
    assert 29 in kept


def test_the_text_of_a_message_is_that_of_its_latest_packet() -> None:
    latest = LatestMessages()
    shown = []
    for roll in (0.5, 0.25):
        latest.store(packet(message=common.Attitude(roll=roll)), 100 + roll)
        found = latest.find(1, 30)
        shown += [json.loads(latest_json(found, 101)) for _ in range(2)]
    assert [each["fields"]["roll"] for each in shown] == [0.5, 0.5, 0.25, 0.25]
    assert [each["count"] for each in shown] == [1, 1, 2, 2]
