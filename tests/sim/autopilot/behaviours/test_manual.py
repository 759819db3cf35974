"""By hand, for all types."""

from __future__ import annotations

from math import atan2, hypot, isfinite

import pytest

from mavstack.sim.autopilot.behaviours import Acro, AltitudeHold, Manual, PositionHold, Stabilize
from mavstack.sim.autopilot.radio import Sticks
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.autopilot.harness import AutopilotHarness, turned

CENTRED = Sticks(0.0, 0.0, 0.5, 0.0)
ALL = [Manual, Stabilize, Acro, AltitudeHold, PositionHold]


def hold_sticks(flight: AutopilotHarness, seconds: float, **moved: float) -> None:
    flight.radio.sticks = CENTRED._replace(**moved)
    flight.run(seconds)


def manual_control(
    behaviour: type[Manual], kind: VehicleType = VehicleType.COPTER, height: float = 20.0
) -> AutopilotHarness:
    flight = AutopilotHarness(kind)
    if kind.flies:
        flight.in_the_air(height)
    else:
        flight.arm()
    flight.fly(lambda autopilot: behaviour(autopilot, forward=kind is VehicleType.VTOL or None))
    flight.run(0.2)
    return flight


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize("behaviour", [Manual, Stabilize, AltitudeHold, PositionHold])
def test_a_copter_rolls_right_and_flies_right(behaviour: type[Manual]) -> None:
    flight = manual_control(behaviour)
    hold_sticks(flight, 2.0, roll=0.6, throttle=0.52)
    assert flight.body.truth.roll > 0.03
    assert flight.body.truth.velocity_east > 1.0


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize("behaviour", [Manual, Stabilize, AltitudeHold, PositionHold])
def test_a_copter_with_the_stick_pushed_flies_ahead(behaviour: type[Manual]) -> None:
    flight = manual_control(behaviour)
    hold_sticks(flight, 2.0, pitch=-0.6, throttle=0.52)
    assert flight.body.truth.velocity_north > 1.0


@pytest.mark.flight
@pytest.mark.parametrize("behaviour", [AltitudeHold, PositionHold])
def test_the_throttle_climbs_and_centred_it_stays_as_high(behaviour: type[Manual]) -> None:
    flight = manual_control(behaviour)
    hold_sticks(flight, 4.0, throttle=0.9)
    assert flight.body.truth.velocity_down == pytest.approx(-2.5 * 0.783, abs=0.5)
    hold_sticks(flight, 4.0)
    height = flight.height
    flight.run(15)
    assert flight.height == pytest.approx(height, abs=0.8)
    hold_sticks(flight, 3.0, throttle=0.1)
    assert flight.body.truth.velocity_down > 1.2


@pytest.mark.flight
def test_leaning_in_altitude_hold_keeps_the_altitude() -> None:
    flight = manual_control(AltitudeHold)
    hold_sticks(flight, 6.0, pitch=-0.7)
    assert flight.height == pytest.approx(20.0, abs=2.0)
    assert flight.speed > 5


@pytest.mark.flight
def test_position_hold_stays_where_it_stopped() -> None:
    flight = manual_control(PositionHold)
    hold_sticks(flight, 3.0, pitch=-1.0)
    assert flight.speed > 4.0
    hold_sticks(flight, 6.0)
    here = flight.body.truth
    flight.run(15)
    assert flight.distance(here[:2]) < 1.5


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize("behaviour", [Stabilize, AltitudeHold, PositionHold, Acro])
def test_the_yaw_stick_turns_a_copter(behaviour: type[Manual]) -> None:
    flight = manual_control(behaviour)
    hold_sticks(flight, 2.0, yaw=0.5)
    assert flight.body.truth.yaw_rate == pytest.approx(1.5 * 0.457, abs=0.15)


@pytest.mark.flight
def test_acro_turns_at_rates() -> None:
    flight = manual_control(Acro)
    hold_sticks(flight, 0.5, roll=0.3)
    assert flight.body.truth.roll_rate == pytest.approx(3.0 * 0.239, abs=0.3)


@pytest.mark.fast_cases(3)
@pytest.mark.parametrize("behaviour", ALL)
def test_on_the_ground_with_the_throttle_closed_it_stays_and_disarms(behaviour: type[Manual]) -> None:
    flight = AutopilotHarness()
    flight.radio.sticks = CENTRED._replace(throttle=0.0)
    flight.arm()
    flight.fly(behaviour)
    flight.run(9.5)
    assert flight.height == 0.0
    flight.run(2)
    assert not flight.autopilot.armed


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize("behaviour", ALL)
def test_the_throttle_lifts_it_off(behaviour: type[Manual]) -> None:
    flight = AutopilotHarness()
    flight.radio.sticks = CENTRED._replace(throttle=0.0)
    flight.arm()
    flight.fly(behaviour)
    flight.run(1)
    hold_sticks(flight, 3.0, throttle=0.75)
    assert flight.height > 1.0


@pytest.mark.flight
def test_lowered_to_the_ground_by_hand_it_rests() -> None:
    flight = manual_control(AltitudeHold, height=4.0)
    hold_sticks(flight, 8.0, throttle=0.0)
    assert flight.autopilot.landed
    flight.run_until(lambda: not flight.autopilot.armed, timeout=12)


@pytest.mark.flight
@pytest.mark.flight_cases(1)
@pytest.mark.parametrize("kind", [VehicleType.PLANE, VehicleType.VTOL])
@pytest.mark.parametrize("behaviour", [Stabilize, AltitudeHold, PositionHold])
def test_a_wing_banks_into_a_turn(kind: VehicleType, behaviour: type[Manual]) -> None:
    flight = manual_control(behaviour, kind, 60.0)
    hold_sticks(flight, 8.0, throttle=0.6)
    before = flight.body.truth.yaw
    hold_sticks(flight, 3.0, roll=0.7, throttle=0.6)
    assert flight.body.truth.roll > 0.1
    assert 0.15 < turned(flight.body.truth.yaw - before) < 3.0


@pytest.mark.nightly
def test_a_wing_keeps_its_course_and_altitude() -> None:
    flight = manual_control(PositionHold, VehicleType.PLANE, 60.0)
    hold_sticks(flight, 12.0)
    motion = flight.body.truth
    course, height = atan2(motion.velocity_east, motion.velocity_north), flight.height
    flight.run(20)
    motion = flight.body.truth
    assert abs(turned(atan2(motion.velocity_east, motion.velocity_north) - course)) < 0.15
    assert flight.height == pytest.approx(height, abs=5.0)
    hold_sticks(flight, 4.0, pitch=0.8)
    assert flight.body.truth.velocity_down < -1.0


@pytest.mark.flight_cases(3)
@pytest.mark.fast_cases(2)
@pytest.mark.parametrize("behaviour", ALL)
@pytest.mark.parametrize("kind", [VehicleType.ROVER, VehicleType.BOAT])
def test_what_drives_goes_and_turns(kind: VehicleType, behaviour: type[Manual]) -> None:
    flight = manual_control(behaviour, kind)
    flight.run(5)
    assert flight.distance() < 2.0
    hold_sticks(flight, 6.0, throttle=0.9)
    assert flight.speed > 0.8
    before = flight.body.truth.yaw
    hold_sticks(flight, 1.0, throttle=0.9, roll=0.5)
    assert turned(flight.body.truth.yaw - before) > 0.1
    hold_sticks(flight, 8.0, throttle=0.2)
    motion = flight.body.truth
    assert hypot(motion.velocity_north, motion.velocity_east) > 0.3, "it reverses"


@pytest.mark.flight_cases(1)
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("behaviour", [Manual, Stabilize, AltitudeHold, PositionHold])
def test_a_sub_dives_and_swims(behaviour: type[Manual]) -> None:
    flight = manual_control(behaviour, VehicleType.SUB)
    hold_sticks(flight, 12.0, throttle=0.1)
    assert flight.body.truth.down > 1.5
    hold_sticks(flight, 6.0, pitch=-0.8)
    assert flight.speed > 0.3
    assert flight.body.truth.velocity_north > 0.2
    hold_sticks(flight, 5.0)
    depth = flight.body.truth.down
    flight.run(8)
    if behaviour in (AltitudeHold, PositionHold):
        assert flight.body.truth.down == pytest.approx(depth, abs=0.5)


@pytest.mark.flight_cases(8)
@pytest.mark.fast_cases(7)
@pytest.mark.parametrize("kind", list(VehicleType))
@pytest.mark.parametrize("behaviour", ALL)
def test_the_sticks_may_be_anywhere(kind: VehicleType, behaviour: type[Manual]) -> None:
    flight = AutopilotHarness(kind)
    flight.arm()
    flight.fly(behaviour)
    for roll in (-1.0, 1.0):
        for throttle in (0.0, 1.0):
            hold_sticks(flight, 1.0, roll=roll, pitch=roll, throttle=throttle, yaw=-roll)
    assert all(isfinite(value) for value in flight.body.truth)
