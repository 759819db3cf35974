from __future__ import annotations

from itertools import islice
from math import inf, nan

import pytest

from mavstack.dialects import common
from mavstack.services import Address, Priority
from mavstack.services.terrain import TerrainServer, locate
from mavstack.services.terrain.server import MAX_BLOCKS, MAX_VEHICLES
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import feed_random_messages, sent_by
from tests.services.terrain.heights import PLACE, hills, request

BLOCK = locate(*PLACE, 100).block
OTHER = Address(2, 1)


def take(server: TerrainServer, count: int) -> list:
    """Return the next messages of a link that has room for so many."""
    return list(islice(server.messages_to_send(START), count))


def test_each_tile_of_the_mask_is_sent_to_the_vehicle_once():
    server = TerrainServer(GROUND, hills)
    server.receive(request(BLOCK, 0b1 | 1 << 9 | 1 << 55), START)
    sent = list(server.messages_to_send(START))
    assert [outgoing.message.gridbit for outgoing in sent] == [0, 9, 55]
    assert {(outgoing.target, outgoing.priority) for outgoing in sent} == {(VEHICLE, Priority.BULK)}
    message = sent[1].message
    assert (message.lat, message.lon, message.grid_spacing) == BLOCK
    assert list(message.data) == [round(hills(*place)) for place in BLOCK.tile_positions(9)]
    assert sent_by(server) == []
    assert server.sent == 3


def test_nothing_is_made_without_room():
    server = TerrainServer(GROUND, lambda *_: pytest.fail("asked for a height"))
    server.receive(request(BLOCK), START)
    assert list(server.messages_to_send(START, lambda target, priority=Priority.BULK: False)) == []


def test_a_repeated_request_continues_behind_the_last_tile():
    server = TerrainServer(GROUND, hills)
    server.receive(request(BLOCK, 0b11111), START)
    assert [each.message.gridbit for each in take(server, 2)] == [0, 1]
    server.receive(request(BLOCK, 0b11111), START + 2)
    assert [message.gridbit for message in sent_by(server)] == [2, 3, 4, 0, 1]
    server.receive(request(BLOCK, 0b10001), START + 4)
    assert [message.gridbit for message in sent_by(server)] == [4, 0]


def test_vehicles_are_served_in_turn():
    server = TerrainServer(GROUND, hills)
    server.receive(request(BLOCK, 0b111), START)
    server.receive(request(BLOCK, 0b11, OTHER), START)
    assert [outgoing.target.system for outgoing in take(server, 9)] == [1, 2, 1, 2, 1]


@pytest.mark.parametrize("unknown", [None, nan, inf])
def test_a_tile_with_an_unknown_height_is_not_sent(unknown):
    first = next(BLOCK.tile_positions(1))
    server = TerrainServer(GROUND, lambda *place: unknown if place == first else 5.0)
    server.receive(request(BLOCK, 0b111), START)
    assert [message.gridbit for message in sent_by(server)] == [0, 2]
    assert (server.sent, server.unknown) == (2, 1)


def test_heights_are_whole_metres_that_fit_the_message():
    heights = iter([1e9, -1e9, 0.6, *[0.0] * 13])
    server = TerrainServer(GROUND, lambda *_: next(heights))
    server.receive(request(BLOCK), START)
    assert list(sent_by(server)[0].data)[:4] == [32_767, -32_768, 1, 0]


def test_impossible_requests_are_ignored():
    server = TerrainServer(GROUND, hills)
    for block in (BLOCK._replace(spacing=0), BLOCK._replace(latitude=2**31 - 1)):
        assert server.receive(request(block), START) is False
    assert server.receive(request(BLOCK, 1 << 56), START) is False
    assert sent_by(server) == []


def test_requests_are_bounded():
    server = TerrainServer(GROUND, lambda *_: 0.0)
    for number in range(3 * MAX_BLOCKS):
        server.receive(request(BLOCK._replace(latitude=number)), START)
    assert len(sent_by(server)) == MAX_BLOCKS
    for number in range(2 * MAX_VEHICLES):
        server.receive(request(BLOCK, 1, Address(1 + number % 255, 1 + number // 255)), START)
    assert len(sent_by(server)) == MAX_VEHICLES


def test_any_content_does_no_harm():
    for seed in range(3):
        feed_random_messages(TerrainServer(GROUND, lambda *_: 0.0), [common.TerrainRequest], seed)
