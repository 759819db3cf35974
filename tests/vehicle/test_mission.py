"""Missions: flown to their end, paused, followed; firmwares that tell their state, and older ones."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ActionTimeout, CommandDenied, MissionWarning
from mavstack.services.mission import MissionItem
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.rows import ITEMS
from tests.vehicle.failures.scripted import ARDUPILOT, CMD, PX4, play
from tests.vehicle.world import ARDUPILOT as ARDUPILOT_SIM
from tests.vehicle.world import PX4 as PX4_SIM
from tests.vehicle.world import fly, named

STATE = common.MissionState
COPTERS = pytest.mark.parametrize(
    "kind", [(VehicleType.COPTER, ARDUPILOT_SIM), (VehicleType.COPTER, PX4_SIM)], ids=named
)
BOTH = pytest.mark.parametrize("autopilot", [PX4, ARDUPILOT], ids=["px4", "ardupilot"])


def plan_for(world, ending, ardupilot):
    """Home where ArduPilot wants it, up, around, and an ending."""
    frame = world.simulated.body.frame

    def item(command, north=0.0, east=0.0, up=15.0):
        latitude, longitude, _ = frame.to_global(north, east, 0.0)
        return MissionItem(command, param5=latitude, param6=longitude, param7=up)

    home = [item(CMD.NAV_WAYPOINT, up=0.0)] if ardupilot else []
    around = [item(CMD.NAV_WAYPOINT, north, east) for north, east in ((30, 0), (30, 30))]
    returns = ending == CMD.NAV_RETURN_TO_LAUNCH
    last = MissionItem(ending, frame=common.MavFrame.MISSION) if returns else item(ending, 0, 30, 0.0)
    return [*home, item(CMD.NAV_TAKEOFF), *around, last]


@pytest.mark.flight_cases(2)
@pytest.mark.flight
@COPTERS
@pytest.mark.parametrize("ending", [CMD.NAV_RETURN_TO_LAUNCH, CMD.NAV_LAND], ids=["rtl", "land"])
def test_flown_to_its_end(kind, ending):
    async def scenario(world, vehicle):
        first = 1 if kind[1] == ARDUPILOT_SIM else 0
        await vehicle.mission.upload(plan_for(world, ending, bool(first)))
        async with vehicle.mission.reached_items() as passing:
            await vehicle.mission.fly()
            reached = [each.seq for each in passing.drain()]
        assert world.simulated.body.truth.down > -1.0
        await world.wait_until(lambda: vehicle.armed is False, timeout=20)
        assert {first + 1, first + 2} <= set(reached)

    fly(kind, scenario)


@pytest.mark.nightly
@COPTERS
def test_paused_and_resumed(kind):
    async def scenario(world, vehicle):
        items = plan_for(world, CMD.NAV_RETURN_TO_LAUNCH, kind[1] == ARDUPILOT_SIM)
        await vehicle.mission.upload(items)
        await vehicle.arm()
        await vehicle.mission.start()
        await world.wait_until(lambda: -world.simulated.body.truth.down > 12)
        flying = asyncio.create_task(vehicle.mission.fly())
        await asyncio.sleep(6)
        await vehicle.mission.pause()
        with pytest.raises(ActionInterrupted, match="flying the mission of 1/1 failed: it changed to"):
            await flying
        before = world.simulated.body.truth.north
        await asyncio.sleep(10)
        assert abs(world.simulated.body.truth.north - before) < 12
        await vehicle.mission.fly()
        assert not vehicle.armed or world.simulated.body.truth.down > -1.0

    fly(kind, scenario)


async def flown(made, *, limit=None):
    """A mission that is under way, once it was asked for."""
    made.script.arm()
    await made.vehicle.mission.upload(ITEMS)
    await asyncio.sleep(1.5)
    flying = asyncio.create_task(made.vehicle.mission.fly(timeout=limit))
    await asyncio.sleep(3)
    return flying


def report_item(made, seq, state=STATE.UNKNOWN, total=None):
    """An older firmware's MISSION_CURRENT has no state, and counts nothing."""
    made.script.send(
        common.MissionCurrent(seq=seq, total=len(ITEMS) if total is None else total, mission_state=state)
    )


def reach(made, seq):
    made.script.send(common.MissionItemReached(seq=seq))


@BOTH
def test_an_older_firmware_ends_with_its_last_item(autopilot):
    async def scenario(made):
        flying = await flown(made)
        first = 1 if autopilot == ARDUPILOT else 0
        total = len(ITEMS) - first
        for seq in range(first, len(ITEMS)):
            assert not flying.done()
            report_item(made, seq, total=total)
            await asyncio.sleep(2)
            assert not flying.done()
            reach(made, seq)
            await asyncio.sleep(0.5)
        await asyncio.wait_for(flying, 3)

    play(scenario, autopilot=autopilot)


@pytest.mark.parametrize("mode", ["LAND", "RTL"])
def test_an_older_firmware_that_lands_ends_with_its_motors(mode):
    async def scenario(made):
        flying = await flown(made)
        report_item(made, len(ITEMS) - 1)
        reach(made, len(ITEMS) - 2)
        made.script.enter(mode)
        reach(made, len(ITEMS) - 1)
        await asyncio.sleep(20)
        assert not flying.done()
        made.script.arm(False)
        await asyncio.wait_for(flying, 3)

    play(scenario)


def test_a_vehicle_that_disarms_in_its_last_item_has_landed():
    async def scenario(made):
        flying = await flown(made)
        reach(made, 0)
        report_item(made, len(ITEMS) - 1)
        await asyncio.sleep(5)
        assert not flying.done()
        made.script.arm(False)
        await asyncio.wait_for(flying, 3)

    play(scenario)


@pytest.mark.parametrize("state", [STATE.UNKNOWN, STATE.ACTIVE])
def test_disarmed_before_the_end_is_an_interruption(state):
    async def scenario(made):
        flying = await flown(made)
        reach(made, 1)
        report_item(made, 2, state)
        await asyncio.sleep(5)
        made.say("Crash: disarming", 0)
        made.script.arm(False)
        with pytest.raises(ActionInterrupted, match=r"it was disarmed 20 m above home \(Crash: disarming\)"):
            await flying

    play(scenario)


@pytest.mark.parametrize("state", [STATE.UNKNOWN, STATE.ACTIVE])
def test_a_landing_at_the_end_is_the_end_if_the_total_counts_the_home_item(state):
    """ArduCopter 4.7 disarms in the landing, stays in AUTO and goes on reporting an active mission."""

    async def scenario(made):
        made.script.arm()
        items = [*ITEMS[:-1], MissionItem.land(47.4, 8.55)]
        await made.vehicle.mission.upload(items)
        await asyncio.sleep(1.5)
        flying = asyncio.create_task(made.vehicle.mission.fly())
        await asyncio.sleep(3)
        for seq in range(1, len(items)):
            report_item(made, seq, state)
            await asyncio.sleep(2)
            assert not flying.done()
            reach(made, seq - 1)
        made.script.landed = common.MavLandedState.ON_GROUND
        made.script.arm(False)
        await asyncio.wait_for(flying, 5)

    play(scenario, autopilot=ARDUPILOT)


def test_commands_behind_the_landing_are_not_waited_for():
    async def scenario(made):
        made.script.arm()
        items = [*ITEMS[:4], MissionItem.land(47.4, 8.55), MissionItem(CMD.DO_SET_SERVO, 1, 1500)]
        await made.vehicle.mission.upload(items)
        await asyncio.sleep(1.5)
        flying = asyncio.create_task(made.vehicle.mission.fly())
        await asyncio.sleep(3)
        report_item(made, 4, STATE.ACTIVE, total=len(items) - 1)
        await asyncio.sleep(3)
        made.script.arm(False)
        await asyncio.wait_for(flying, 5)

    play(scenario, autopilot=ARDUPILOT)


def test_a_vehicle_that_disarms_before_its_landing_was_interrupted():
    async def scenario(made):
        made.script.arm()
        await made.vehicle.mission.upload([*ITEMS[:4], MissionItem.land(47.4, 8.55)])
        await asyncio.sleep(1.5)
        flying = asyncio.create_task(made.vehicle.mission.fly())
        await asyncio.sleep(3)
        report_item(made, 3, STATE.ACTIVE, total=4)
        await asyncio.sleep(3)
        made.script.arm(False)
        with pytest.raises(ActionInterrupted, match="it was disarmed"):
            await flying

    play(scenario, autopilot=ARDUPILOT)


def test_the_download_gives_back_what_was_uploaded_though_item_0_is_the_home():
    async def scenario(world, vehicle):
        items = plan_for(world, CMD.NAV_LAND, ardupilot=True)
        items[0] = MissionItem.home()
        sent = await vehicle.mission.upload(items)
        assert world.simulated.mission.plan(0).items[0] != items[0]
        assert await vehicle.mission.download() == sent
        other = [items[0], *items[2:]]
        await vehicle.component.mission.upload(other)
        assert (await vehicle.mission.download()).items[1:] == tuple(other[1:])
        vehicle.component.mission._uploaded = sent
        assert (await vehicle.mission.download()).items[0] != items[0], "another plan: the vehicle's own home"

    fly((VehicleType.COPTER, ARDUPILOT_SIM), scenario)


@BOTH
def test_a_mission_that_begins_far_away_gets_a_warning(autopilot):
    async def scenario(made):
        await made.vehicle.get_position()
        far = [MissionItem.home(), MissionItem.takeoff(10), MissionItem.waypoint(-35.36, 149.16, 20)]
        with pytest.warns(
            MissionWarning, match=r"begins 18,\d\d\d km from the vehicle: item 2 is at -35\.36"
        ):
            await made.vehicle.mission.upload(far)
        assert made.script.mission.plan(0).items == tuple(far)
        await made.vehicle.mission.upload([MissionItem.home(), MissionItem.waypoint(47.4, 8.55, 20)])

    play(scenario, autopilot=autopilot)


def test_the_mission_state_reports_the_end():
    async def scenario(made):
        flying = await flown(made)
        report_item(made, 3, STATE.ACTIVE)
        await asyncio.sleep(3)
        report_item(made, len(ITEMS) - 1, STATE.ACTIVE)
        await asyncio.sleep(3)
        assert not flying.done()
        report_item(made, len(ITEMS) - 1, STATE.COMPLETE)
        await asyncio.wait_for(flying, 3)

    play(scenario)


def test_the_end_of_an_earlier_flight_does_not_count():
    async def scenario(made):
        made.script.arm()
        await made.vehicle.mission.upload(ITEMS)
        report_item(made, len(ITEMS) - 1, STATE.COMPLETE)
        await asyncio.sleep(1.5)
        flying = asyncio.create_task(made.vehicle.mission.fly())
        await asyncio.sleep(10)
        assert not flying.done()
        report_item(made, 0, STATE.ACTIVE)
        await asyncio.sleep(2)
        report_item(made, len(ITEMS) - 1, STATE.COMPLETE)
        await asyncio.wait_for(flying, 3)

    play(scenario)


def test_a_vehicle_that_reports_no_progress_ends_with_the_timeout():
    async def scenario(made):
        flying = await flown(made, limit=40)
        with pytest.raises(ActionTimeout, match="flying the mission of 1/1 failed: not done in 40 s"):
            await flying

    play(scenario)


def test_it_arms_first_and_a_refused_arming_ends_the_call():
    async def scenario(made):
        made.script.arm(False)
        await made.vehicle.mission.upload(ITEMS)
        await asyncio.sleep(1.5)
        made.script.refuse(CMD.COMPONENT_ARM_DISARM)
        made.script.saying = lambda: made.say("PreArm: no fix")
        made.script.heard.clear()
        with pytest.raises(CommandDenied, match=r"COMPONENT_ARM_DISARM .*: DENIED \(PreArm: no fix\)"):
            await made.vehicle.mission.fly()
        modes = [each for each in made.script.heard if getattr(each, "command", None) == CMD.DO_SET_MODE]
        assert modes == []

    play(scenario)


def test_items_and_progress():
    async def scenario(made):
        async with made.vehicle.mission.reached_items() as items:
            report_item(made, 2, STATE.ACTIVE)
            reach(made, 1)
            reach(made, 1)
            reach(made, 2)
            await asyncio.sleep(0.2)
            assert [each.seq for each in items.drain()] == [1, 2]
        assert made.vehicle.mission.progress.seq == 2
        assert made.vehicle.mission.progress.state == STATE.ACTIVE

    play(scenario)
