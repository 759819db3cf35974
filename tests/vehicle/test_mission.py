"""Missions: flown to their end, paused and followed, with and without the state in MISSION_CURRENT."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ActionTimeout, CommandDenied, MissionWarning
from mavstack.services.mission import MissionItem
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.rows import ITEMS
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT, CMD, PX4, run_scenario
from tests.vehicle.world import ARDUPILOT as ARDUPILOT_SIM
from tests.vehicle.world import PX4 as PX4_SIM
from tests.vehicle.world import fly, kind_name

STATE = common.MissionState
COPTERS = pytest.mark.parametrize(
    "kind", [(VehicleType.COPTER, ARDUPILOT_SIM), (VehicleType.COPTER, PX4_SIM)], ids=kind_name
)
BOTH = pytest.mark.parametrize("autopilot", [PX4, ARDUPILOT], ids=["px4", "ardupilot"])


def plan_for(world, ending, ardupilot):
    """Return a takeoff, two waypoints and the last item; ArduPilot's plans begin with the home position."""
    frame = world.simulated.body.frame

    def item(command, north=0.0, east=0.0, up=15.0):
        latitude, longitude, _ = frame.to_global(north, east, 0.0)
        return MissionItem(command, param5=latitude, param6=longitude, param7=up)

    home = [item(CMD.NAV_WAYPOINT, up=0.0)] if ardupilot else []
    around = [item(CMD.NAV_WAYPOINT, north, east) for north, east in ((30, 0), (30, 30))]
    returns = ending == CMD.NAV_RETURN_TO_LAUNCH
    last = MissionItem(ending, frame=common.MavFrame.MISSION) if returns else item(ending, 0, 30, 0.0)
    return [*home, item(CMD.NAV_TAKEOFF), *around, last]


@pytest.mark.flight_cases(1)
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


async def start_mission(harness, *, limit=None):
    """Upload a mission and return the running `fly` call."""
    harness.autopilot.arm()
    await harness.vehicle.mission.upload(ITEMS)
    await asyncio.sleep(1.5)
    flying = asyncio.create_task(harness.vehicle.mission.fly(timeout=limit))
    await asyncio.sleep(3)
    return flying


def report_item(harness, seq, state=STATE.UNKNOWN, total=None):
    """Send MISSION_CURRENT; that of older firmwares has no state and no total."""
    harness.autopilot.send(
        common.MissionCurrent(seq=seq, total=len(ITEMS) if total is None else total, mission_state=state)
    )


def reach(harness, seq):
    harness.autopilot.send(common.MissionItemReached(seq=seq))


@BOTH
def test_an_older_firmware_ends_with_its_last_item(autopilot):
    async def scenario(harness):
        flying = await start_mission(harness)
        first = 1 if autopilot == ARDUPILOT else 0
        total = len(ITEMS) - first
        for seq in range(first, len(ITEMS)):
            assert not flying.done()
            report_item(harness, seq, total=total)
            await asyncio.sleep(2)
            assert not flying.done()
            reach(harness, seq)
            await asyncio.sleep(0.5)
        await asyncio.wait_for(flying, 3)

    run_scenario(scenario, autopilot=autopilot)


@pytest.mark.parametrize("mode", ["LAND", "RTL"])
def test_an_older_firmware_that_lands_ends_with_its_motors(mode):
    async def scenario(harness):
        flying = await start_mission(harness)
        report_item(harness, len(ITEMS) - 1)
        reach(harness, len(ITEMS) - 2)
        harness.autopilot.enter(mode)
        reach(harness, len(ITEMS) - 1)
        await asyncio.sleep(20)
        assert not flying.done()
        harness.autopilot.arm(False)
        await asyncio.wait_for(flying, 3)

    run_scenario(scenario)


def test_a_vehicle_that_disarms_in_its_last_item_has_landed():
    async def scenario(harness):
        flying = await start_mission(harness)
        reach(harness, 0)
        report_item(harness, len(ITEMS) - 1)
        await asyncio.sleep(5)
        assert not flying.done()
        harness.autopilot.arm(False)
        await asyncio.wait_for(flying, 3)

    run_scenario(scenario)


@pytest.mark.parametrize("state", [STATE.UNKNOWN, STATE.ACTIVE])
def test_disarmed_before_the_end_is_an_interruption(state):
    async def scenario(harness):
        flying = await start_mission(harness)
        reach(harness, 1)
        report_item(harness, 2, state)
        await asyncio.sleep(5)
        harness.send_statustext("Crash: disarming", 0)
        harness.autopilot.arm(False)
        with pytest.raises(ActionInterrupted, match=r"it was disarmed 20 m above home \(Crash: disarming\)"):
            await flying

    run_scenario(scenario)


@pytest.mark.parametrize("state", [STATE.UNKNOWN, STATE.ACTIVE])
def test_a_landing_at_the_end_is_the_end_if_the_total_counts_the_home_item(state):
    """ArduCopter 4.7 disarms in the landing, stays in AUTO and continues to report an active mission."""

    async def scenario(harness):
        harness.autopilot.arm()
        items = [*ITEMS[:-1], MissionItem.land(47.4, 8.55)]
        await harness.vehicle.mission.upload(items)
        await asyncio.sleep(1.5)
        flying = asyncio.create_task(harness.vehicle.mission.fly())
        await asyncio.sleep(3)
        for seq in range(1, len(items)):
            report_item(harness, seq, state)
            await asyncio.sleep(2)
            assert not flying.done()
            reach(harness, seq - 1)
        harness.autopilot.landed = common.MavLandedState.ON_GROUND
        harness.autopilot.arm(False)
        await asyncio.wait_for(flying, 5)

    run_scenario(scenario, autopilot=ARDUPILOT)


def test_commands_behind_the_landing_are_not_waited_for():
    async def scenario(harness):
        harness.autopilot.arm()
        items = [*ITEMS[:4], MissionItem.land(47.4, 8.55), MissionItem(CMD.DO_SET_SERVO, 1, 1500)]
        await harness.vehicle.mission.upload(items)
        await asyncio.sleep(1.5)
        flying = asyncio.create_task(harness.vehicle.mission.fly())
        await asyncio.sleep(3)
        report_item(harness, 4, STATE.ACTIVE, total=len(items) - 1)
        await asyncio.sleep(3)
        harness.autopilot.arm(False)
        await asyncio.wait_for(flying, 5)

    run_scenario(scenario, autopilot=ARDUPILOT)


def test_a_vehicle_that_disarms_before_its_landing_was_interrupted():
    async def scenario(harness):
        harness.autopilot.arm()
        await harness.vehicle.mission.upload([*ITEMS[:4], MissionItem.land(47.4, 8.55)])
        await asyncio.sleep(1.5)
        flying = asyncio.create_task(harness.vehicle.mission.fly())
        await asyncio.sleep(3)
        report_item(harness, 3, STATE.ACTIVE, total=4)
        await asyncio.sleep(3)
        harness.autopilot.arm(False)
        with pytest.raises(ActionInterrupted, match="it was disarmed"):
            await flying

    run_scenario(scenario, autopilot=ARDUPILOT)


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
    async def scenario(harness):
        await harness.vehicle.get_position()
        far = [MissionItem.home(), MissionItem.takeoff(10), MissionItem.waypoint(-35.36, 149.16, 20)]
        with pytest.warns(
            MissionWarning, match=r"begins 18,\d\d\d km from the vehicle: item 2 is at -35\.36"
        ):
            await harness.vehicle.mission.upload(far)
        assert harness.autopilot.mission.plan(0).items == tuple(far)
        await harness.vehicle.mission.upload([MissionItem.home(), MissionItem.waypoint(47.4, 8.55, 20)])

    run_scenario(scenario, autopilot=autopilot)


def test_the_mission_state_reports_the_end():
    async def scenario(harness):
        flying = await start_mission(harness)
        report_item(harness, 3, STATE.ACTIVE)
        await asyncio.sleep(3)
        report_item(harness, len(ITEMS) - 1, STATE.ACTIVE)
        await asyncio.sleep(3)
        assert not flying.done()
        report_item(harness, len(ITEMS) - 1, STATE.COMPLETE)
        await asyncio.wait_for(flying, 3)

    run_scenario(scenario)


def test_the_end_of_an_earlier_flight_does_not_count():
    async def scenario(harness):
        harness.autopilot.arm()
        await harness.vehicle.mission.upload(ITEMS)
        report_item(harness, len(ITEMS) - 1, STATE.COMPLETE)
        await asyncio.sleep(1.5)
        flying = asyncio.create_task(harness.vehicle.mission.fly())
        await asyncio.sleep(10)
        assert not flying.done()
        report_item(harness, 0, STATE.ACTIVE)
        await asyncio.sleep(2)
        report_item(harness, len(ITEMS) - 1, STATE.COMPLETE)
        await asyncio.wait_for(flying, 3)

    run_scenario(scenario)


def test_a_vehicle_that_reports_no_progress_ends_with_the_timeout():
    async def scenario(harness):
        flying = await start_mission(harness, limit=40)
        with pytest.raises(ActionTimeout, match="flying the mission of 1/1 failed: not done in 40 s"):
            await flying

    run_scenario(scenario)


def test_it_arms_first_and_a_refused_arming_ends_the_call():
    async def scenario(harness):
        harness.autopilot.arm(False)
        await harness.vehicle.mission.upload(ITEMS)
        await asyncio.sleep(1.5)
        harness.autopilot.refuse(CMD.COMPONENT_ARM_DISARM)
        harness.autopilot.on_refusal = lambda: harness.send_statustext("PreArm: no fix")
        harness.autopilot.received.clear()
        with pytest.raises(CommandDenied, match=r"arming .*: DENIED \(PreArm: no fix\)"):
            await harness.vehicle.mission.fly()
        modes = [
            each for each in harness.autopilot.received if getattr(each, "command", None) == CMD.DO_SET_MODE
        ]
        assert modes == []

    run_scenario(scenario)


def test_items_and_progress():
    async def scenario(harness):
        async with harness.vehicle.mission.reached_items() as items:
            report_item(harness, 2, STATE.ACTIVE)
            reach(harness, 1)
            reach(harness, 1)
            reach(harness, 2)
            await asyncio.sleep(0.2)
            assert [each.seq for each in items.drain()] == [1, 2]
        assert harness.vehicle.mission.progress.seq == 2
        assert harness.vehicle.mission.progress.state == STATE.ACTIVE

    run_scenario(scenario)
