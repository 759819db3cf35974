from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from mavstack.bridges.core.plain_json import json_bytes
from mavstack.bridges.core.snapshots import GROUPS, snapshot
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.world import ARDUPILOT, PX4, World, fly, kind_name

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle


@pytest.mark.parametrize("kind", [(VehicleType.COPTER, ARDUPILOT), (VehicleType.ROVER, PX4)], ids=kind_name)
def test_all_groups_are_json(kind: tuple[VehicleType, str]) -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        await vehicle.get_position()
        await vehicle.wait_until_ready()
        found = {group: json.loads(json_bytes(snapshot(vehicle, group))) for group in GROUPS}
        assert found["status"]["system"] == 1
        assert found["status"]["armed"] is False
        assert found["position"]["latitude"] == pytest.approx(vehicle.position.latitude)
        assert found["position"]["velocity"]["north"] == pytest.approx(0, abs=0.5)
        assert found["health"]["ready"] is True
        assert 0 < found["battery"]["remaining"] <= 100

    fly(kind, scenario)
