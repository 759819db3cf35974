"""A live recording of a simulated vehicle, in virtual time."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest

from mavstack.bridges.core.bridge import Bridge
from mavstack.bridges.mcap.sink import McapSink
from mavstack.errors import LogError
from mavstack.sim.vehicle_types import VehicleType
from tests.bridges.mcap.test_log_export import read_by_mcap, read_by_rosbags
from tests.vehicle.world import ARDUPILOT, World, fly

if TYPE_CHECKING:
    from pathlib import Path

    from mavstack.vehicle import Vehicle


def test_a_live_recording_by_two_readers(tmp_path: Path) -> None:
    path = tmp_path / "live.mcap"

    async def scenario(world: World, vehicle: Vehicle) -> None:
        await vehicle.get_position()
        sink = McapSink(path)
        async with Bridge(world.node, [sink]):
            await asyncio.sleep(3)
        assert sink.dropped == 0

    fly((VehicleType.COPTER, ARDUPILOT), scenario)
    first, second = read_by_mcap(path), read_by_rosbags(path)
    assert {topic: len(each) for topic, each in first.items()} == {
        topic: len(each) for topic, each in second.items()
    }
    assert {"/mavros/imu/data", "/mavros/state", "/tf", "/diagnostics"} <= set(first)
    assert first["/mavros/imu/data"][-1].linear_acceleration.z == pytest.approx(9.8, abs=0.6)


def test_an_existing_file_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "live.mcap"
    path.write_bytes(b"x")
    with pytest.raises(LogError, match="it exists"):
        McapSink(path)
    assert path.read_bytes() == b"x"
