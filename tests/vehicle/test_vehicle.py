"""A vehicle's own calls: any command, versions, estimator sources, transitions, termination, shortcuts."""

from __future__ import annotations

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import ActionUnsupported, CommandDenied
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.scripted import ARDUPILOT as ARDUPILOT_NUMBER
from tests.vehicle.failures.scripted import CMD, RESULT, play
from tests.vehicle.firmware.asked import INT, LONG, asked_of
from tests.vehicle.world import ARDUPILOT, PX4, fly

COPTER = (VehicleType.COPTER, ARDUPILOT)
FIRMWARES = [ARDUPILOT, PX4]


def test_any_command():
    async def scenario(made):
        result = await made.vehicle.command(CMD.DO_SET_HOME, 1)
        assert result.result == RESULT.ACCEPTED
        await made.vehicle.command(
            CMD.DO_REPOSITION, -1, 1, 0, 0, 47.4, 8.5, 20, frame=common.MavFrame.GLOBAL
        )
        assert asked_of(made) == [
            (LONG, "DO_SET_HOME", 1, 0, 0, 0, 0, 0, 0),
            (INT, "DO_REPOSITION", "GLOBAL", -1, 1, 0, 0, 47.4, 8.5, 20),
        ]
        made.script.refuse(CMD.DO_SET_HOME)
        made.script.saying = lambda: made.say("no position")
        with pytest.raises(CommandDenied, match=r"DO_SET_HOME on 1/1 failed: DENIED \(no position\)"):
            await made.vehicle.command(CMD.DO_SET_HOME, 1)

    play(scenario)


@pytest.mark.parametrize("firmware", FIRMWARES)
def test_the_version_is_kept(firmware):
    async def scenario(world, vehicle):
        version = await vehicle.get_version()
        assert version.can(common.MavProtocolCapability.MAVLINK2)
        assert vehicle.version == version

    fly((VehicleType.COPTER, firmware), scenario)


def test_estimator_sources():
    async def scenario(made):
        await made.vehicle.set_ekf_source(2)
        (asked,) = asked_of(made)
        assert asked[1:3] == (ardupilotmega.MavCmd.SET_EKF_SOURCE_SET.name, 2)

    play(scenario, autopilot=ARDUPILOT_NUMBER)


def test_px4_has_no_estimator_sources():
    async def scenario(made):
        with pytest.raises(ActionUnsupported, match="cannot change the sources of its estimator"):
            await made.vehicle.set_ekf_source(1)
        assert asked_of(made) == []

    play(scenario)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", FIRMWARES)
def test_transitions(firmware):
    async def scenario(world, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(40)
        await vehicle.hold()  # PX4 refuses transitions in its takeoff mode
        if firmware is ARDUPILOT:
            await vehicle.set_mode("GUIDED")
        await vehicle.transition_to_fixed_wing()
        assert vehicle.vtol_state == common.MavVtolState.FW
        assert vehicle.ground_speed is not None
        assert vehicle.climb_rate is not None
        await vehicle.transition_to_multicopter()
        assert vehicle.vtol_state == common.MavVtolState.MC

    fly((VehicleType.VTOL, firmware), scenario)


def test_a_copter_has_no_transitions():
    async def scenario(made):
        with pytest.raises(ActionUnsupported, match="cannot change to fixed-wing flight: it is a copter"):
            await made.vehicle.transition_to_fixed_wing()
        assert asked_of(made) == []

    play(scenario)


@pytest.mark.parametrize("firmware", FIRMWARES)
def test_termination(firmware):
    async def scenario(world, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(8)
        await vehicle.terminate()
        await world.wait_until(lambda: vehicle.landed_state == common.MavLandedState.ON_GROUND)
        assert world.simulated.autopilot.terminated or not world.simulated.autopilot.armed

    fly((VehicleType.COPTER, firmware), scenario)
