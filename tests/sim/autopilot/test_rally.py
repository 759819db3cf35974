"""Where to return to."""

from __future__ import annotations

import pytest

from mavstack.services.mission import MissionItem, PlanType
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, VehicleType
from tests.sim.autopilot.harness import RETURN
from tests.sim.autopilot.mission.harness import CMD, FRAME, MissionHarness, item

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4


def point(north: float, east: float, up: float = 30.0, frame: int = FRAME.GLOBAL_RELATIVE_ALT) -> MissionItem:
    return item(CMD.NAV_RALLY_POINT, at=(north, east, up), frame=frame)


def at(
    north: float, *points: MissionItem, firmware: Firmware = ARDUPILOT, **parameters: float
) -> MissionHarness:
    flight = MissionHarness(VehicleType.COPTER, firmware)
    flight.vehicle.parameters |= parameters
    assert flight.upload(*points, kind=PlanType.RALLY) == 0
    flight.body.place(north, 0.0, 0.0, 0.0)
    flight.run(2)
    flight.autopilot.set_home(DEFAULT_HOME.latitude, DEFAULT_HOME.longitude, DEFAULT_HOME.altitude)
    return flight


def test_the_nearest() -> None:
    flight = at(200, point(100, 0, 40), point(300, 50, 50))
    nearest = flight.autopilot.rally.nearest()
    assert nearest == pytest.approx((100, 0, -40), abs=0.2)
    assert flight.autopilot.rally.destination() == pytest.approx((100, 0, 0), abs=0.2)


@pytest.mark.parametrize("firmware", list(Firmware))
def test_without_any_it_is_home(firmware: Firmware) -> None:
    flight = at(50, firmware=firmware)
    assert flight.autopilot.rally.nearest() is None
    assert flight.autopilot.rally.destination() == pytest.approx((0, 0, 0), abs=0.1)


@pytest.mark.parametrize(("limit", "found"), [(0, True), (0.05, False), (0.2, True)])
def test_the_limit(limit: float, found: bool) -> None:
    flight = at(300, point(400, 0), RALLY_LIMIT_KM=limit)
    assert (flight.autopilot.rally.nearest() is not None) == found


@pytest.mark.parametrize(("counts", "found"), [(0, True), (1, False)])
def test_home_may_count_as_one(counts: int, found: bool) -> None:
    flight = at(50, point(150, 0), RALLY_INCL_HOME=counts)
    assert (flight.autopilot.rally.nearest() is not None) == found


@pytest.mark.flight
def test_px4_takes_home_if_it_is_nearer() -> None:
    assert at(50, point(150, 0), firmware=PX4).autopilot.rally.nearest() is None
    assert at(100, point(150, 0), firmware=PX4).autopilot.rally.nearest() is not None


def test_absolute_altitudes() -> None:
    flight = at(100, point(150, 0, DEFAULT_HOME.altitude + 25, FRAME.GLOBAL))
    nearest = flight.autopilot.rally.nearest()
    assert nearest is not None
    assert nearest[2] == pytest.approx(-25, abs=0.2)


@pytest.mark.nightly
@pytest.mark.flight
def test_returning_to_one() -> None:
    flight = MissionHarness()
    flight.upload(point(40, 0), kind=PlanType.RALLY)
    flight.in_the_air(15)
    flight.enter(RETURN)
    flight.run_until(lambda: not flight.autopilot.armed, timeout=120)
    assert flight.distance((40, 0)) < 3
