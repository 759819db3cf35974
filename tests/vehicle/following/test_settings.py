"""The parameters by which firmwares follow, and their values after a refusal."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle.following.settings import Place, follow_settings
from tests.vehicle.world import ARDUPILOT, fly

COPTER, ROVER, BOAT = (
    (each, ARDUPILOT) for each in (VehicleType.COPTER, VehicleType.ROVER, VehicleType.BOAT)
)


@pytest.mark.parametrize(("kind", "gain"), [(COPTER, None), (ROVER, 1.0), (BOAT, 1.0)])
def test_vehicles_on_a_surface_get_a_larger_gain(kind, gain):
    async def scenario(world, vehicle):
        parameters = follow_settings(vehicle, Place(-10.0, 2.0, 0.0), 7, 0.0).parameters
        assert next(iter(parameters)) == "FOLL_ENABLE", "it shows the other parameters"
        assert parameters["FOLL_SYSID"] == 7.0
        assert parameters.get("FOLL_POS_P") == gain

    fly(kind, scenario)


def test_a_refused_mode_leaves_the_parameters_as_they_were():
    async def scenario(world, rover):
        leader = await world.node.wait_for_vehicle(2)
        await rover.arm()
        await rover.params.set("FOLL_ENABLE", 1.0)
        await rover.params.set("FOLL_SYSID", 9.0)
        before = {each: (await rover.params.get(each)).value for each in ("FOLL_POS_P", "FOLL_SYSID")}
        asked = []

        def refuse(request):
            asked.append(request.command.param2)
            return common.MavResult.DENIED

        world.simulated.services.commands.support(common.MavCmd.DO_SET_MODE, refuse)
        with pytest.raises(CommandDenied):
            await rover.follow(leader, level="radio")
        assert asked
        after = {each: (await rover.params.get(each)).value for each in before}
        assert after == before
        assert before["FOLL_POS_P"] == pytest.approx(0.1)

    fly([ROVER, COPTER], scenario)
