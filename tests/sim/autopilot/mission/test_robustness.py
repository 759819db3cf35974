"""Whatever is uploaded is refused or flown, and never raises."""

from __future__ import annotations

from math import inf, isfinite, nan

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan, PlanType
from mavstack.sim.autopilot.mission.scripts import SCRIPTS
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, VehicleType
from tests.sim.autopilot.harness import HOLD
from tests.sim.autopilot.mission.harness import FRAME, GROUND, RESULT, MissionHarness, item

NUMBERS = (
    some.sampled_from([0.0, 1.0, -1.0, 2.0, 3.0, 8.0, 60.0, 1900.0, nan, inf, -inf, 3.4e38, -3.4e38, 1e-30])
    | some.floats(-200, 200)
)  # fmt: skip
LATITUDES = some.floats(-0.001, 0.001).map(lambda offset: DEFAULT_HOME.latitude + offset) | NUMBERS
LONGITUDES = some.floats(-0.001, 0.001).map(lambda offset: DEFAULT_HOME.longitude + offset) | NUMBERS
COMMANDS = some.sampled_from(sorted(int(command) for command in SCRIPTS)) | some.integers(0, 65535)
FRAMES = some.sampled_from([FRAME.GLOBAL_RELATIVE_ALT, FRAME.MISSION, FRAME.GLOBAL]) | some.integers(0, 21)
ITEMS = some.builds(
    MissionItem,
    COMMANDS,
    NUMBERS,
    NUMBERS,
    NUMBERS,
    NUMBERS,
    LATITUDES,
    LONGITUDES,
    NUMBERS,
    frame=FRAMES,
)
LISTS = some.lists(ITEMS, min_size=1, max_size=6)
COMMON = settings(
    max_examples=25,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)


def flown(flight: MissionHarness, seconds: float) -> None:
    """Fly whatever there is, in the air and on the ground, and look that it stays somewhere."""
    if flight.mission.start() is not None:
        flight.enter(2)  # the mission's mode, whatever its rules say
    for _ in range(round(seconds)):
        flight.run(1)
        assert all(map(isfinite, flight.body.truth))
        assert flight.server.current_message().to_payload() is not None


@pytest.mark.fast_cases(3)
@pytest.mark.parametrize("firmware", list(Firmware))
@pytest.mark.parametrize("kind", list(VehicleType))
def test_any_upload_is_answered(kind: VehicleType, firmware: Firmware) -> None:
    flight = MissionHarness(kind, firmware)

    @settings(COMMON, max_examples=60)
    @given(LISTS, some.sampled_from(list(PlanType)[:3]))
    def check(items: list[MissionItem], plan_type: int) -> None:
        result = flight.upload(*items, kind=plan_type)
        assert result in set(common.MavMissionResult)
        if result == RESULT.ACCEPTED:
            assert flight.vehicle.plans.get(plan_type).items == tuple(items)

    check()


@pytest.mark.nightly
@pytest.mark.parametrize("firmware", list(Firmware))
@pytest.mark.parametrize("kind", [VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL, VehicleType.ROVER])
def test_what_is_accepted_can_be_flown(kind: VehicleType, firmware: Firmware) -> None:
    flight = MissionHarness(kind, firmware)
    if kind.flies:
        flight.in_the_air(40)
    else:
        flight.arm()

    @COMMON
    @given(LISTS)
    def check(items: list[MissionItem]) -> None:
        flight.enter(HOLD)
        accepted = [
            each for each in items if flight.mission.check(PlanType.MISSION, 1, each) == RESULT.ACCEPTED
        ]
        flight.upload(item(common.MavCmd.NAV_WAYPOINT, frame=FRAME.GLOBAL), *accepted)
        if not flight.autopilot.armed:
            flight.arm()
        flown(flight, 6)

    check()


@pytest.mark.nightly
@pytest.mark.parametrize("kind", [VehicleType.COPTER, VehicleType.SUB])
def test_even_a_store_of_anything_is_flown(kind: VehicleType) -> None:
    """As from a file that an older version wrote."""
    flight = MissionHarness(kind)

    @COMMON
    @given(LISTS)
    def check(items: list[MissionItem]) -> None:
        flight.enter(HOLD)
        for plan_type in list(PlanType)[:3]:
            flight.server.replace(Plan.of(items, plan_type))
        if not flight.autopilot.armed:
            flight.arm()
        flown(flight, 5)
        flight.mission.validate(Plan.of(items), GROUND)
        flight.autopilot.rally.nearest()
        flight.autopilot.fence.check()
        assert flight.autopilot.fence.breach_distance() >= 0

    check()
