"""The key and the MAVLink version that the URL of a simulated vehicle's link gives."""

from __future__ import annotations

from time import time

import pytest

from mavstack.errors import LinkURLError, RemoteTimeout
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import VehicleType
from mavstack.sim.virtual import run_virtually
from tests.sim.running import reduce_telemetry, running


def heard_from(query: str, *, key: SigningKey | None = None) -> set[tuple[int, bool]]:
    """Ping a vehicle on a link with options; return the version of its packets, and if they are signed."""
    heard: set[tuple[int, bool]] = set()

    async def work() -> None:
        network, simulation = MemoryNetwork(), Simulation(seed=5, start=float(int(time())))
        reduce_telemetry(simulation.add(VehicleType.COPTER))
        ground = Node(network.link("memory://net"), signing=key)
        async with running(simulation, network.link(f"memory://net{query}")), ground:
            ground.add_packet_listener(None, lambda packet: heard.add((packet.version, packet.signed)))
            await (await ground.wait_for_autopilot(timeout=10)).ping(timeout=5)
        simulation.close()

    run_virtually(work())
    return heard


def test_a_vehicle_sends_the_version_of_its_link() -> None:
    assert heard_from("") == {(2, False)}
    assert heard_from("?mavlink=1") == {(1, False)}


def test_a_vehicle_signs_with_the_key_of_its_link(tmp_path) -> None:
    key = SigningKey.generate()
    key.save(tmp_path / "fleet.key")
    query = f"?signing_key={tmp_path}/fleet.key"
    assert heard_from(query, key=key) == {(2, True)}
    with pytest.raises(RemoteTimeout):
        heard_from(query)


@pytest.mark.parametrize("option", ["id=7", "heartbeat_rate=2"])
async def test_a_vehicle_keeps_its_own_identity(option) -> None:
    async with Runner(Simulation()) as runner:
        with pytest.raises(LinkURLError, match="simulated vehicles do not use the option"):
            await runner.connect(f"udpin://127.0.0.1:0?{option}", [])
