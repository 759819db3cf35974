"""A plan means the same in a file, on ArduPilot and on PX4, though they count its items differently."""

from __future__ import annotations

import pytest
from hypothesis import given

from mavstack.dialects import common
from mavstack.files.plans import Home, PlanFile, parse_plan
from mavstack.files.plans.model import CMD, FRAME, params_of
from mavstack.services.addressing import Address
from mavstack.services.mission import MissionItem, Plan, PlanType
from tests.files.plans.plans import FLIGHT, HOMES, SMALL, missions, names


def test_ardupilot_counts_the_home():
    plan = parse_plan(FLIGHT).mission_for(home_first=True)
    assert names(plan) == ["NAV_WAYPOINT", "NAV_TAKEOFF", *["NAV_WAYPOINT"] * 2, "DO_JUMP",
                           "NAV_RETURN_TO_LAUNCH"]  # fmt: skip
    assert params_of(plan.items[0])[4:] == (47.3977419, 8.5455939, 488)
    assert plan.items[0].frame == FRAME.GLOBAL
    assert plan.items[4].param1 == 2


def test_px4_does_not_count_the_home():
    plan = parse_plan(FLIGHT).mission_for(home_first=False)
    assert len(plan) == 5
    assert plan.items[3].param1 == 1


def test_an_empty_mission_stays_empty():
    assert len(PlanFile(home=Home(1, 2)).mission_for(home_first=True)) == 0
    assert PlanFile.of_vehicle([Plan(PlanType.MISSION)], home_first=True).home is None


@given(missions(SMALL), HOMES)
def test_a_plan_survives_upload_and_download(mission, home):
    plan = PlanFile.of(mission, home=home if mission else None)
    there = plan.mission_for(home_first=True)
    back = PlanFile.of_vehicle([over_the_wire(there)], home_first=True)
    assert back.mission == plan.mission
    if plan.home is not None and back.home is not None:
        assert back.home.latitude == pytest.approx(plan.home.latitude, abs=1e-7)
    there = plan.mission_for(home_first=False)
    assert PlanFile.of_vehicle([over_the_wire(there)], home_first=False).mission == plan.mission


def over_the_wire(plan: Plan) -> Plan:
    target = Address(1, 1)
    messages = [item.to_int(target, seq, plan.type) for seq, item in enumerate(plan.items)]
    return Plan.of(
        MissionItem.read(common.MissionItemInt.from_payload(each.to_payload())) for each in messages
    )


def test_numbers_from_the_wire_are_short():
    item = MissionItem(CMD.NAV_WAYPOINT, 0.15, 2.7, 1e-7, 123456.78, 47.3977419, 8.5455939, 520.3)
    held = over_the_wire(Plan.of([item]))
    assert held.items[0].param1 != 0.15
    (got,) = PlanFile.of_vehicle([held], home_first=False).mission.items
    assert params_of(got) == (0.15, 2.7, 1e-7, 123456.78, 47.3977419, 8.5455939, 520.3)
    assert got == held.items[0]


def test_frames_from_the_wire_are_those_of_files():
    item = MissionItem(CMD.NAV_WAYPOINT, frame=FRAME.GLOBAL_RELATIVE_ALT_INT, current=True)
    (got,) = PlanFile.of_vehicle([Plan.of([item])], home_first=False).mission.items
    assert (got.frame, got.current) == (FRAME.GLOBAL_RELATIVE_ALT, False)


def test_the_home_goes_with_the_mission():
    plan = parse_plan(FLIGHT)
    assert plan.only([PlanType.FENCE]).home is None
    assert plan.only([PlanType.FENCE]).kinds == (PlanType.FENCE,)
    assert plan.only([PlanType.MISSION, PlanType.RALLY]).home == plan.home
