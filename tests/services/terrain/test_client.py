from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import BROADCAST
from mavstack.services.terrain import (
    TerrainBlockLoaded,
    TerrainCheckServer,
    TerrainClient,
    TerrainMap,
    locate,
    moved,
)
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import feed_random_messages, packet_of, run_timers
from tests.services.terrain.heights import PLACE, data, filled_map

FAR = moved(*PLACE, 10_000, 0)


def client_of(*positions, terrain: TerrainMap | None = None) -> TerrainClient:
    return TerrainClient(VEHICLE, terrain or TerrainMap(), lambda: positions, START)


def fill(client: TerrainClient, block) -> None:
    for tile in range(56):
        client.receive(data(block, tile), START)


def test_one_request_every_two_seconds_and_the_first_position_first():
    client = client_of(PLACE, FAR)
    sent = run_timers(client, START + 5)
    assert [time - START for time, _ in sent] == [0, 2, 4]
    own, far = (locate(*place, 100).block for place in (PLACE, FAR))
    assert {(message.lat, message.lon) for _, message in sent} == {own[:2]}
    assert sent[0][1] == common.TerrainRequest(*own, mask=2**56 - 1)
    fill(client, own)
    assert [message.lat for _, message in run_timers(client, START + 6)] == [far.latitude]
    fill(client, far)
    assert run_timers(client, START + 20) == []


def test_a_request_goes_to_all_ground_stations():
    client = client_of(PLACE)
    client.handle_timeout(START)
    (outgoing,) = client.messages_to_send(START)
    assert outgoing.target == BROADCAST


def test_only_missing_tiles_are_requested_again():
    client = client_of(PLACE)
    (block,) = (locate(*PLACE, 100).block,)
    run_timers(client, START)
    client.receive(data(block, 0), START)
    client.receive(data(block, 55), START)
    ((_, request),) = run_timers(client, START + 2)
    assert request.mask == (2**56 - 1) & ~1 & ~(1 << 55)


def test_a_block_is_reported_when_it_is_complete():
    client = client_of(PLACE)
    run_timers(client, START)
    block = locate(*PLACE, 100).block
    fill(client, block)
    assert client.events() == [TerrainBlockLoaded(block)]
    assert client.receive(data(block, 3), START) is False
    assert client.events() == []


def test_nothing_is_requested_while_nothing_is_wanted():
    terrain = TerrainMap()
    terrain.want(*PLACE)
    assert run_timers(client_of(terrain=terrain), START + 10) == []


def test_blocks_of_a_check_are_requested_after_the_wanted_ones():
    terrain = filled_map(PLACE)
    terrain.want(*FAR)
    ((_, request),) = run_timers(client_of(PLACE, terrain=terrain), START)
    assert request.lat == locate(*FAR, 100).block.latitude


def test_a_check_is_answered_to_its_sender_with_its_position():
    asked = []

    def report(latitude: float, longitude: float) -> common.TerrainReport:
        asked.append((latitude, longitude))
        return common.TerrainReport(spacing=100, terrain_height=488.0)

    server = TerrainCheckServer(VEHICLE, report)
    server.receive(packet_of(common.TerrainCheck(473_977_001, 85_456_002), GROUND), START)
    (outgoing,) = server.messages_to_send(START)
    assert outgoing.target == GROUND
    assert (outgoing.message.lat, outgoing.message.lon) == (473_977_001, 85_456_002)
    assert asked == [pytest.approx((47.3977001, 8.5456002))]
    server.receive(packet_of(common.TerrainCheck(2**31 - 1, 0), GROUND), START)
    assert list(server.messages_to_send(START)) == []


def test_any_content_does_no_harm():
    for seed in range(2):
        feed_random_messages(client_of(PLACE), [common.TerrainData], seed)
        report = TerrainCheckServer(VEHICLE, lambda *_: common.TerrainReport())
        feed_random_messages(report, [common.TerrainCheck], seed)
