"""Terrain over random networks: at any loss below 60 % every tile arrives, as the ground station has it."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import TYPE_CHECKING

from mavstack.services import Address
from mavstack.services.terrain import TerrainClient, TerrainMap, TerrainServer, locate, moved
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts
from tests.services.terrain.heights import PLACE, hills

if TYPE_CHECKING:
    from tests.seeds import Seeds

OTHER = Address(254, 190)


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    terrain, count = TerrainMap(random.choice([30, 100])), random.choice([1, 1, 2, 3])
    wanted = [moved(*PLACE, random.uniform(-9e3, 9e3), random.uniform(-9e3, 9e3)) for _ in range(count)]
    known = set(random.sample(range(56), random.choice([0, 40, 52])))  # before the start, which saves time
    for place in wanted:
        terrain.want(*place)
        for tile in known:
            terrain.store(locate(*place, terrain.spacing).block, tile, [0] * 16)
    vehicle = network.node(
        VEHICLE, lambda engine: engine.add(TerrainClient(VEHICLE, terrain, lambda: wanted, network.now))
    )
    for address in (GROUND, OTHER)[: random.choice([1, 1, 2])]:
        ground = network.node(address)
        impairment = replace(random_impairment(random), loss=random.choice([0.0, random.uniform(0, 0.6)]))
        with_cuts(
            network, network.connect(ground, vehicle, impairment, bandwidth=impairment.bandwidth or None)
        )
        ground.engine.add(TerrainServer(address, hills))
    if random.random() < 0.2:
        network.at(random.uniform(0, 3), vehicle.restart)
    assert network.run(lambda: not terrain.pending, timeout=1800)
    for block, stored in terrain._blocks.items():
        for tile in set(range(0, 56, 11)) - known:
            east, north = tile % 8 * 4, tile // 8 * 4
            heights = [stored.height(north + point // 4, east + point % 4) for point in range(16)]
            assert heights == [round(hills(*place)) for place in block.tile_positions(tile)]


def test_terrain_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
