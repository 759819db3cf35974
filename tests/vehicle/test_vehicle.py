"""A vehicle's own calls: any command, versions, estimator sources, transitions, termination, shortcuts."""

from __future__ import annotations

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import ActionUnsupported, CommandDenied
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT as ARDUPILOT_NUMBER
from tests.vehicle.failures.scripted_autopilot import CMD, RESULT, run_scenario
from tests.vehicle.firmware.received_requests import INT, LONG, requests_of
from tests.vehicle.world import ARDUPILOT, PX4, fly

COPTER = (VehicleType.COPTER, ARDUPILOT)
FIRMWARES = [ARDUPILOT, PX4]


def test_any_command():
    async def scenario(harness):
        result = await harness.vehicle.command(CMD.DO_SET_HOME, 1)
        assert result.result == RESULT.ACCEPTED
        await harness.vehicle.command(
            CMD.DO_REPOSITION, -1, 1, 0, 0, 47.4, 8.5, 20, frame=common.MavFrame.GLOBAL
        )
        assert requests_of(harness) == [
            (LONG, "DO_SET_HOME", 1, 0, 0, 0, 0, 0, 0),
            (INT, "DO_REPOSITION", "GLOBAL", -1, 1, 0, 0, 47.4, 8.5, 20),
        ]
        harness.autopilot.refuse(CMD.DO_SET_HOME)
        harness.autopilot.on_refusal = lambda: harness.send_statustext("no position")
        with pytest.raises(CommandDenied, match=r"DO_SET_HOME on 1/1 failed: DENIED \(no position\)"):
            await harness.vehicle.command(CMD.DO_SET_HOME, 1)

    run_scenario(scenario)


@pytest.mark.parametrize("firmware", FIRMWARES)
def test_the_version_is_kept(firmware):
    async def scenario(world, vehicle):
        version = await vehicle.get_version()
        assert version.can(common.MavProtocolCapability.MAVLINK2)
        assert vehicle.version == version

    fly((VehicleType.COPTER, firmware), scenario)


def test_estimator_sources():
    async def scenario(harness):
        await harness.vehicle.set_ekf_source(2)
        (asked,) = requests_of(harness)
        assert asked[1:3] == (ardupilotmega.MavCmd.SET_EKF_SOURCE_SET.name, 2)

    run_scenario(scenario, autopilot=ARDUPILOT_NUMBER)


def test_px4_has_no_estimator_sources():
    async def scenario(harness):
        with pytest.raises(ActionUnsupported, match="cannot change the sources of its estimator"):
            await harness.vehicle.set_ekf_source(1)
        assert requests_of(harness) == []

    run_scenario(scenario)


@pytest.mark.nightly
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
    async def scenario(harness):
        with pytest.raises(ActionUnsupported, match="cannot change to fixed-wing flight: it is a copter"):
            await harness.vehicle.transition_to_fixed_wing()
        assert requests_of(harness) == []

    run_scenario(scenario)


@pytest.mark.parametrize("firmware", FIRMWARES)
def test_termination(firmware):
    async def scenario(world, vehicle):
        await vehicle.arm()
        await vehicle.takeoff(8)
        await vehicle.terminate()
        await world.wait_until(lambda: vehicle.landed_state == common.MavLandedState.ON_GROUND)
        assert world.simulated.autopilot.terminated or not world.simulated.autopilot.armed

    fly((VehicleType.COPTER, firmware), scenario)
