from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mavstack.sim.motion import Body, World
from mavstack.sim.motion.airframes import AIRFRAMES, LIMIT_RANGES
from mavstack.sim.vehicle_types import Home, VehicleType
from tests.sim.motion.flights import HOME, speed, step_for

TYPES = list(VehicleType)
#: Maximum speed (m/s) of each type in still air, dives and falls included.
MAX_SPEED = {"copter": 45, "plane": 75, "vtol": 80, "rover": 9, "boat": 6, "sub": 2.5}
ANY_FLOAT = st.floats(allow_nan=True, allow_infinity=True)
METRES = st.one_of(st.floats(-300, 300), ANY_FLOAT)
SMALL = st.one_of(st.floats(-3, 3), ANY_FLOAT)
OPTIONAL = st.one_of(st.none(), SMALL)
POINT = st.tuples(METRES, METRES, METRES)

DEMANDS = st.one_of(
    st.tuples(st.just("go_to"), POINT, st.fixed_dictionaries({"start": st.none() | POINT, "speed": OPTIONAL,
              "climb": OPTIONAL, "sink": OPTIONAL, "yaw": OPTIONAL})),
    st.tuples(st.just("fly_velocity"), st.tuples(METRES, METRES, SMALL), st.fixed_dictionaries({
              "yaw": OPTIONAL,
              "yaw_rate": OPTIONAL})),
    st.tuples(st.just("circle"), st.tuples(METRES, METRES, METRES, METRES), st.fixed_dictionaries({
              "speed": OPTIONAL, "yaw": OPTIONAL})),
    st.tuples(st.just("hold_attitude"), st.tuples(SMALL, SMALL, OPTIONAL, SMALL), st.just({})),
    st.tuples(st.just("hold_rates"), st.tuples(SMALL, SMALL, SMALL, SMALL), st.just({})),
    st.tuples(st.just("sticks"), st.tuples(SMALL, SMALL, SMALL, SMALL), st.just({})),
    st.tuples(st.sampled_from(["stop", "idle", "roll_out"]), st.just(()), st.just({})),
    st.tuples(st.just("transition_to"), st.tuples(st.booleans()), st.just({})),
    st.tuples(st.just("set_limit"), st.tuples(st.sampled_from(sorted(LIMIT_RANGES)), SMALL), st.just({})),
    st.tuples(st.just("fail_motor"), st.tuples(st.integers(-1, 9), st.booleans()), st.just({})),
    st.tuples(st.just("fail_gps"), st.tuples(st.booleans()), st.just({})),
    st.tuples(st.just("spoof_gps"), st.tuples(METRES, METRES), st.just({})),
    st.tuples(st.sampled_from(["offset_compass", "sag_battery", "drift_barometer"]), st.tuples(SMALL),
              st.just({})),
)  # fmt: skip
PLANS = st.lists(st.tuples(st.integers(0, len(TYPES) - 1), DEMANDS), min_size=1, max_size=10)
PLACES = st.lists(st.floats(0, 100), min_size=len(TYPES), max_size=len(TYPES))
WINDS = st.tuples(st.one_of(st.floats(0, 15), ANY_FLOAT), ANY_FLOAT, ANY_FLOAT)


def all_types(seed: int = 1) -> tuple[World, list[Body]]:
    world = World(seed=seed)
    return world, [world.add(vehicle_type, HOME) for vehicle_type in TYPES]


def energy(body: Body) -> float:
    """Return potential and kinetic energy per mass."""
    return -9.80665 * body.truth.down + 0.5 * speed(body.truth) ** 2


def assert_physical(body: Body, wind: float) -> None:
    """Check the invariants of any moving body."""
    motion = body.truth
    assert all(math.isfinite(value) for value in (*motion, *body.estimate, *body.battery, body.airspeed))
    assert speed(motion) < MAX_SPEED[body.vehicle_type] + wind
    assert abs(motion.pitch) <= math.pi / 2 + 0.1
    assert abs(motion.roll) <= math.pi + 1e-6
    assert max(abs(motion.roll_rate), abs(motion.pitch_rate), abs(motion.yaw_rate)) <= 12.0
    airframe = AIRFRAMES[body.vehicle_type]
    assert airframe.ceiling <= motion.down <= airframe.floor
    assert 0.0 <= body.throttle <= 1.0
    assert 0.0 <= body.transition <= 1.0
    assert body.battery.current >= 0.0
    readings = body.sensors
    assert all(math.isfinite(value) for name, value in readings._asdict().items() if name != "distance")


@pytest.mark.nightly
@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(PLANS, PLACES, WINDS)
def test_random_demands_keep_the_state_physical(plan, heights, wind):
    world, bodies = all_types()
    world.set_wind(*wind)
    max_gust = 2.5 * min(wind[0], 60.0) if wind[0] > 0 else 0.0
    for body, height in zip(bodies, heights, strict=True):
        body.place(0, 0, -height, 0)
    for index, (name, arguments, options) in plan:
        body = bodies[index]
        getattr(body, name)(*arguments, **options)
        charges = [b.battery.consumed for b in bodies]
        for _ in range(15):
            world.step()
        for other_body, charge in zip(bodies, charges, strict=True):
            assert_physical(other_body, max_gust)
            assert other_body.battery.consumed >= charge
    assert np.isfinite(world.state.data).all()


@pytest.mark.flight
@settings(max_examples=20, deadline=None)
@given(st.sampled_from(TYPES), st.lists(DEMANDS, min_size=1, max_size=5), st.floats(5, 100))
def test_energy_comes_from_motors_only(vehicle_type, demands, height):
    world = World()
    body = world.add(vehicle_type, HOME)
    body.place(0, 0, -height, 0)
    airframe = AIRFRAMES[vehicle_type]
    max_gust = 1.1 * (airframe.lift * 1.8 + airframe.drive) + 0.1
    before = energy(body)
    for name, arguments, options in demands:
        getattr(body, name)(*arguments, **options)
        for _ in range(20):
            world.step()
            now = energy(body)
            assert now - before <= max_gust * (speed(body.truth) + 0.5) / 50 + 0.3
            before = now


@pytest.mark.flight
@given(st.integers(0, 2**32))
@settings(max_examples=3, deadline=None)
def test_same_seed_gives_the_same_state(seed):
    worlds = [all_types(seed) for _ in range(2)]
    for world, bodies in worlds:
        world.set_wind(6, 200, 0.3)
        for body in bodies:
            body.go_to(100, 50, -40)
        step_for(world, 2)
    assert np.array_equal(worlds[0][0].state.data, worlds[1][0].state.data)
    assert worlds[0][1][0].sensors == worlds[1][1][0].sensors


def test_different_seeds_differ():
    (one, bodies), (other, others) = all_types(1), all_types(2)
    step_for(one, 1)
    step_for(other, 1)
    assert all(a.estimate != b.estimate for a, b in zip(bodies, others, strict=True))


@pytest.mark.fast_cases(3)
@pytest.mark.parametrize("added_type", TYPES)
def test_added_body_does_not_change_the_others(added_type):
    def flight(joined: bool) -> list[Body]:
        world, bodies = all_types(3)
        world.set_wind(5, 90, 0.2)
        for body in bodies:
            body.go_to(200, 50, -30)
        step_for(world, 1)
        if joined:
            other = world.add(added_type, Home(10, 10, 0, 45))
            other.go_to(0, 0, -5)
        step_for(world, 1)
        return bodies

    for one, other in zip(flight(False), flight(True), strict=True):
        assert tuple(one.truth) == pytest.approx(tuple(other.truth), abs=1e-9)
        assert tuple(one.sensors[:12]) == pytest.approx(tuple(other.sensors[:12]), abs=1e-9)


@pytest.mark.parametrize("rate", [0.0, 5.0, math.nan, 1e6])
def test_invalid_rate_is_refused(rate):
    with pytest.raises(ValueError, match="rate of a world"):
        World(rate=rate)


def test_time_is_a_multiple_of_the_step():
    world = World(rate=100)
    for _ in range(7):
        world.step()
    assert world.time == 0.07


def test_unknown_limit_raises_key_error():
    _, bodies = all_types()
    with pytest.raises(KeyError):
        bodies[0].set_limit("sped", 1.0)
