"""Modes have one name everywhere: in the list, as the current mode, and in refusals."""

from __future__ import annotations

import pytest

from mavstack.errors import RemoteDenied
from mavstack.services.modes import AvailableMode
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.scripted import PX4 as SCRIPTED_PX4
from tests.vehicle.failures.scripted import play
from tests.vehicle.world import ARDUPILOT, PX4, fly, named

COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)]


@pytest.mark.parametrize("kind", COPTERS, ids=named)
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
    async def scenario(made):
        modes = made.script.modes
        own = AvailableMode(4 << 16 | 11 << 24, "Follow the Bees")
        modes.offer(
            [*(mode for mode in modes.modes if mode.custom_mode != own.custom_mode), own], made.script.now()
        )
        made.script.wake(modes)
        await made.vehicle.set_mode("follow the bees")
        assert made.vehicle.mode == "Follow the Bees"
        assert "Follow the Bees" in [mode.name for mode in await made.vehicle.modes.list()]

    play(scenario, autopilot=SCRIPTED_PX4)
