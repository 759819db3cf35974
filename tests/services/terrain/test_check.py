from __future__ import annotations

from math import nan

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, InvalidTypeError, RemoteTimeout
from mavstack.services import Address
from mavstack.services.terrain import TerrainCheckClient, TerrainCheckServer, TerrainMap
from tests.services.network import GROUND, START, VEHICLE, Network
from tests.services.single_service import packet_of, sent_by
from tests.services.terrain.check_helpers import report_of
from tests.services.terrain.heights import PLACE, filled_map, hills


def pair(terrain: TerrainMap):
    network = Network()
    ground = network.node(GROUND)
    vehicle = network.node(VEHICLE, lambda e: e.add(TerrainCheckServer(VEHICLE, report_of(terrain))))
    network.connect(ground, vehicle)
    return network, ground, ground.engine.add(TerrainCheckClient(GROUND, VEHICLE))


def test_the_height_at_a_position():
    network, ground, client = pair(filled_map(PLACE))
    check = client.check(*PLACE, network.now)
    ground.engine.touch(client)
    assert network.run(lambda: check.done)
    state = check.result()
    assert state.is_known
    assert (state.spacing, state.loaded, state.pending, state.current_height) == (100, 56, 0, 5.0)
    assert state.terrain_height == pytest.approx(hills(*PLACE), abs=4)
    assert (state.latitude, state.longitude) == pytest.approx(PLACE)


def test_a_vehicle_without_the_terrain():
    network, ground, client = pair(TerrainMap())
    check = client.check(*PLACE, network.now)
    ground.engine.touch(client)
    assert network.run(lambda: check.done)
    state = check.result()
    assert not state.is_known
    assert state.terrain_height is None
    assert state.current_height is None


def test_only_the_vehicles_report_of_the_position_is_the_answer():
    client = TerrainCheckClient(GROUND, VEHICLE)
    check = client.check(*PLACE, START)
    (asked,) = sent_by(client)
    answer = common.TerrainReport(asked.lat, asked.lon, spacing=100)
    client.receive(packet_of(answer.replace(lat=asked.lat + 1)), START)
    client.receive(packet_of(answer, Address(2, 1)), START)
    assert not check.done
    client.receive(packet_of(answer), START)
    assert check.result().is_known


def test_a_silent_vehicle():
    client = TerrainCheckClient(GROUND, VEHICLE)
    check = client.check(*PLACE, START)
    while not check.done:
        client.handle_timeout(client.next_timeout())
    with pytest.raises(RemoteTimeout, match="checking the terrain of 1/1 failed after 6 attempts: no answer"):
        check.result()


def test_waiting_ends_when_the_last_position_is_known():
    terrain = filled_map(PLACE)
    network, ground, client = pair(terrain)
    other = (47.5, 8.5)
    wait = client.wait_until_loaded([PLACE, other], network.now)
    ground.engine.touch(client)
    assert not network.run(lambda: wait.done, timeout=20)
    filled = filled_map(PLACE, other)
    terrain._blocks = filled._blocks
    assert network.run(lambda: wait.done, timeout=2)
    assert wait.result() is None


def test_waiting_fails_when_no_tile_arrives():
    network, ground, client = pair(TerrainMap())
    wait = client.wait_until_loaded([PLACE], network.now)
    ground.engine.touch(client)
    assert network.run(lambda: wait.done, timeout=70)
    with pytest.raises(
        RemoteTimeout, match="waiting for terrain data on 1/1 failed: no tile arrived for 60 s"
    ):
        wait.result()
    assert network.now - START == pytest.approx(60, abs=2)


def test_waiting_continues_while_tiles_arrive():
    terrain = TerrainMap()
    network, ground, client = pair(terrain)
    terrain.want(*PLACE)
    (block,) = terrain.incomplete()
    for tile in range(56):
        network.at(50.0 * (tile // 14), lambda tile=tile: terrain.store(block, tile, [0] * 16))
    wait = client.wait_until_loaded([PLACE], network.now)
    ground.engine.touch(client)
    assert network.run(lambda: wait.done, timeout=200)
    assert wait.error is None


@pytest.mark.parametrize("position", [(91, 0), (0, 181), (nan, 0), (0, None), ("47", 8)])
def test_wrong_positions(position):
    client = TerrainCheckClient(GROUND, VEHICLE)
    with pytest.raises((InvalidArgumentError, InvalidTypeError)):
        client.check(*position, START)
    with pytest.raises((InvalidArgumentError, InvalidTypeError)):
        client.wait_until_loaded([position], START)
    assert sent_by(client) == []
