"""A vehicle without a mission is not armed for it: ArduPlane would return to home, from the ground too."""

from __future__ import annotations

import asyncio
from contextlib import suppress

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionRefused, CommandDenied, ModeTimeout
from mavstack.services.mission import MissionItem
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT as SCRIPTED_ARDUPILOT
from tests.vehicle.failures.scripted_autopilot import CMD, RESULT, run_scenario
from tests.vehicle.world import ARDUPILOT, PX4, fly, kind_name

KINDS = [
    *((kind, ARDUPILOT) for kind in (VehicleType.PLANE, VehicleType.COPTER, VehicleType.ROVER)),
    (VehicleType.COPTER, PX4),
]
CALLS = [
    lambda mission: mission.start(),
    lambda mission: mission.start(arm=True),
    lambda mission: mission.fly(),
]
FRAME = common.MavFrame.GLOBAL_RELATIVE_ALT


@pytest.mark.parametrize("kind", KINDS, ids=kind_name)
@pytest.mark.parametrize("armed", [False, True])
def test_an_empty_mission_is_refused_before_the_vehicle_is_armed(kind, armed):
    async def scenario(world, vehicle):
        states = []
        vehicle.component.add_listener(
            common.Heartbeat, lambda beat: states.append((beat.base_mode & 128, beat.custom_mode))
        )
        assert vehicle.mission.progress is None  # from now on it is followed
        await vehicle.telemetry.ensure(common.MissionCurrent, 1.0)
        if armed:
            await vehicle.arm()
        await asyncio.sleep(2)
        states.clear()
        for call in CALLS[not armed :]:
            with pytest.raises(ActionRefused, match="mission of 1/1 failed: it has no mission; upload one"):
                await call(vehicle.mission)
        await asyncio.sleep(2)
        assert len(set(states)) == 1

    fly(kind, scenario)


def test_a_mission_of_home_alone_is_empty():
    async def scenario(world, vehicle):
        home = MissionItem(CMD.NAV_WAYPOINT, param5=47.4, param6=8.5, frame=common.MavFrame.GLOBAL)
        await vehicle.mission.upload([home])
        with pytest.raises(ActionRefused, match="it has no mission"):
            await vehicle.mission.start(arm=True)

    fly((VehicleType.PLANE, ARDUPILOT), scenario)


def test_a_mission_that_another_program_has_sent_is_flown():
    async def scenario(world, vehicle):
        with pytest.raises(ActionRefused, match="it has no mission"):
            await vehicle.mission.start(arm=True)
        there = {"param5": 47.3985, "param6": 8.546, "param7": 40.0, "frame": FRAME}
        items = [
            MissionItem(CMD.NAV_TAKEOFF, param7=40.0, frame=FRAME),
            MissionItem(CMD.NAV_WAYPOINT, **there),
        ]
        await vehicle.component.mission.upload([items[1], *items])
        await vehicle.mission.start(arm=True)
        assert (vehicle.mode, vehicle.armed) == ("AUTO", True)

    fly((VehicleType.PLANE, ARDUPILOT), scenario)


@pytest.mark.parametrize("armed", [False, True])
def test_a_simulated_plane_without_a_mission_returns_as_the_real_one(armed):
    async def scenario(world, vehicle):
        texts = []
        vehicle.component.add_listener(common.Statustext, lambda message: texts.append(message.text))
        if armed:
            await vehicle.arm()
        with suppress(ModeTimeout):
            await vehicle.set_mode("AUTO")
        await world.wait_until(lambda: vehicle.mode == "RTL")
        await asyncio.sleep(1)
        assert texts.count("Mission complete, changing mode to RTL") == 1

    fly((VehicleType.PLANE, ARDUPILOT), scenario)


def test_a_mode_that_was_left_at_once_is_explained():
    async def scenario(harness):
        harness.autopilot.enter("RTL")
        harness.autopilot.executes = False
        setting = asyncio.create_task(harness.vehicle.set_mode("AUTO"))
        await asyncio.sleep(0.5)
        harness.send_statustext("Mission complete, changing mode to RTL", common.MavSeverity.INFO)
        with pytest.raises(ModeTimeout, match=r"reports RTL \(Mission complete, changing mode to RTL\)$"):
            await setting

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, kind=common.MavType.FIXED_WING)


def test_the_reason_before_a_warning_without_one_is_reported():
    """ArduRover says why by a notice, and by a warning only that the mode was not entered."""

    async def scenario(harness):
        def texts():
            harness.send_statustext("No Mission. Can't set AUTO.", common.MavSeverity.NOTICE)
            harness.send_statustext("Flight mode change failed", common.MavSeverity.WARNING)

        harness.autopilot.refuse(CMD.DO_SET_MODE, result=RESULT.FAILED)
        harness.autopilot.on_refusal = texts
        with pytest.raises(CommandDenied) as denied:
            await harness.vehicle.set_mode("AUTO")
        assert denied.value.status_texts == ("No Mission. Can't set AUTO.", "Flight mode change failed")

    run_scenario(scenario, autopilot=SCRIPTED_ARDUPILOT, kind=common.MavType.GROUND_ROVER)
