"""Modes have one name everywhere: in the list, as the current mode, and in refusals."""

from __future__ import annotations

import pytest

from mavstack.errors import RemoteDenied
from mavstack.services.modes import AvailableMode
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.scripted_autopilot import PX4 as SCRIPTED_PX4
from tests.vehicle.failures.scripted_autopilot import run_scenario
from tests.vehicle.world import ARDUPILOT, PX4, fly, kind_name

COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)]


@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
def test_the_listed_name_is_the_current_one(kind):
    async def scenario(world, vehicle):
        listed = {mode.custom_mode: mode.name for mode in await vehicle.modes.list()}
        assert "" not in listed.values()
        assert len(set(listed.values())) == len(listed)
        for name in ("LOITER", "ALTCTL" if kind[1] is PX4 else "ALT_HOLD"):
            number = await vehicle.modes.set(name)
            assert vehicle.mode == listed[number] == name
        if kind[1] is PX4:
            await vehicle.set_mode("Hold")
            assert vehicle.mode == "LOITER"
        with pytest.raises(RemoteDenied) as denied:
            await vehicle.set_mode("HOVERCRAFT")
        assert f"the vehicle has {', '.join(listed.values())}" in str(denied.value)

    fly(kind, scenario)


def test_a_mode_that_only_the_vehicle_knows_has_its_name():
    async def scenario(harness):
        modes = harness.autopilot.modes
        own = AvailableMode(4 << 16 | 11 << 24, "Follow the Bees")
        modes.offer(
            [*(mode for mode in modes.modes if mode.custom_mode != own.custom_mode), own],
            harness.autopilot.now(),
        )
        harness.autopilot.wake(modes)
        await harness.vehicle.set_mode("follow the bees")
        assert harness.vehicle.mode == "Follow the Bees"
        assert "Follow the Bees" in [mode.name for mode in await harness.vehicle.modes.list()]

    run_scenario(scenario, autopilot=SCRIPTED_PX4)
