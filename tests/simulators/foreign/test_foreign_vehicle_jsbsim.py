"""A simulated ArduPlane flies an aircraft of JSBSim."""

from __future__ import annotations

import pytest

from mavstack.simulators import ArduPilotSimulator
from tests.simulators.foreign.worlds import flown, running

pytest.importorskip("jsbsim")
pytestmark = pytest.mark.interop


@pytest.mark.nightly
async def test_a_plane_takes_off_on_jsbsim():
    world = ArduPilotSimulator("jsbsim:J3Cub", listen="udpin://127.0.0.1:0")
    async with running(world), flown("ardupilot", "plane", world.port) as (made, vehicle):
        for name, value in (("AIRSPEED_CRUISE", 28.0), ("AIRSPEED_MIN", 20.0), ("ROLL_LIMIT_DEG", 30.0)):
            made.vehicle.parameters.set(name, value)
        await vehicle.arm()
        await vehicle.takeoff(30)
        assert world.state.position[2] < -25.0
        assert world.state.airspeed > 15.0
