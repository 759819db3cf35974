"""Missions of iNav by the mission protocol."""

from __future__ import annotations

import asyncio
from dataclasses import replace

import pytest

from mavstack.cli.mission import transfer
from mavstack.dialects import common
from mavstack.errors import ActionUnsupported, MissionDenied
from mavstack.msp.messages.navigation import (
    LAST_WAYPOINT_FLAG,
    NavMode,
    NavState,
    SetWp,
    SetWpIndex,
    WaypointAction,
)
from mavstack.services.mission import MissionItem, PlanType
from tests.bridges.msp.fake_controller import FakeController, run

_CMD = common.MavCmd


def waypoint(latitude: float = 47.0, altitude: float = 20.0, **changes: object) -> MissionItem:
    item = MissionItem(_CMD.NAV_WAYPOINT, 0, 0, 0, 0, latitude, 8.0, altitude)
    return replace(item, **changes)


MISSION = [
    waypoint(),
    MissionItem(_CMD.DO_CHANGE_SPEED, 1, 7.5, -1),
    waypoint(47.001),
    MissionItem(_CMD.NAV_RETURN_TO_LAUNCH),
]


def test_up_and_down():
    async def scenario(vehicle, controller, bridge):
        plan = await vehicle.mission.upload(MISSION)
        assert plan.plan_id
        written = [controller.waypoints[number] for number in (1, 2, 3)]
        assert [each.action for each in written] == [1, 1, 4]
        assert [each.parameter_1 for each in written] == [0, 750, 1]
        assert [each.flag for each in written] == [0, 0, LAST_WAYPOINT_FLAG]
        assert list((await vehicle.mission.download()).items) == MISSION

    run(scenario, variant="INAV")


def test_altitudes_are_rounded_to_whole_centimeters():
    async def scenario(vehicle, controller, bridge):
        await vehicle.mission.upload([waypoint(altitude=12.345), waypoint(47.001, 33.333)])
        assert [controller.waypoints[number].flag for number in (1, 2)] == [0, LAST_WAYPOINT_FLAG]

    run(scenario, variant="INAV")


def test_the_mission_of_the_controller_is_read_at_the_start_and_when_it_changes():
    async def scenario(vehicle, controller, bridge):
        controller.waypoints[1] = SetWp(1, WaypointAction.LAND, 47.0, 8.0, 0.0, 0, 0, 0, LAST_WAYPOINT_FLAG)
        await asyncio.sleep(7)
        items = (await vehicle.mission.download()).items
        assert [item.name for item in items] == ["NAV_LAND"]

    run(scenario, variant="INAV")


def test_the_mission_is_known_with_the_first_heartbeat():
    controller = FakeController("INAV")
    controller.waypoints[1] = SetWp(1, WaypointAction.LAND, 47.0, 8.0, 0.0, 0, 0, 0, LAST_WAYPOINT_FLAG)

    async def scenario(vehicle, controller, bridge):
        assert len(await vehicle.mission.download()) == 1

    run(scenario, controller=controller)


def test_an_item_that_it_lacks_is_refused_with_its_number():
    async def scenario(vehicle, controller, bridge):
        with pytest.raises(MissionDenied, match="item 1: iNav has no NAV_TAKEOFF"):
            await vehicle.mission.upload([waypoint(), MissionItem(_CMD.NAV_TAKEOFF, param7=10)])
        assert controller.waypoints == {}

    run(scenario, variant="INAV")


def test_a_mission_that_the_controller_does_not_take_is_refused():
    async def scenario(vehicle, controller, bridge):
        controller._set_waypoint = lambda waypoint: None
        with pytest.raises(MissionDenied, match="it did not take waypoint 1"):
            await vehicle.mission.upload(MISSION)
        assert len(await vehicle.mission.download()) == 0

    run(scenario, variant="INAV")


def test_clearing():
    async def scenario(vehicle, controller, bridge):
        await vehicle.mission.upload(MISSION)
        await vehicle.mission.clear()
        assert len(await vehicle.mission.download()) == 0
        assert all(each.flag == 0 for each in controller.waypoints.values())

    run(scenario, variant="INAV")


def test_progress_and_the_current_item():
    async def scenario(vehicle, controller, bridge):
        await vehicle.mission.upload(MISSION)
        reached = vehicle.mission.reached_items()
        controller.nav = replace(controller.nav, mode=NavMode.NAV, state=NavState.WP_ENROUTE, waypoint=1)
        await asyncio.sleep(2)
        assert vehicle.mission.progress.seq == 0
        controller.nav = replace(controller.nav, waypoint=2)
        await asyncio.sleep(2)
        assert vehicle.mission.progress.seq == 2
        assert [item.seq for item in reached.drain()] == [0]
        await vehicle.mission.set_current(3)
        await asyncio.sleep(0.1)
        assert controller.sent_of(SetWpIndex) == [SetWpIndex(2)]

    run(scenario, variant="INAV")


def test_home():
    async def scenario(vehicle, controller, bridge):
        await asyncio.sleep(2)
        home = await vehicle.get_home()
        assert (home.latitude, home.longitude, home.altitude) == (47.0, 8.0, 487.5)

    run(scenario, variant="INAV")


def test_betaflight_has_none():
    async def scenario(vehicle, controller, bridge):
        with pytest.raises(ActionUnsupported, match="cannot fly missions"):
            await vehicle.mission.upload(MISSION)
        for call in (vehicle.component.mission.upload(MISSION), vehicle.component.mission.download()):
            with pytest.raises(MissionDenied, match="UNSUPPORTED"):
                await call

    run(scenario)


def test_the_command_takes_a_missing_fence_for_an_empty_one():
    async def scenario(vehicle, controller, bridge):
        assert len(await transfer._download(vehicle, PlanType.FENCE, strict=False)) == 0
        for plan_type, strict in ((PlanType.FENCE, True), (PlanType.MISSION, False)):
            with pytest.raises(ActionUnsupported):
                await transfer._download(vehicle, plan_type, strict=strict)

    run(scenario)
