"""Inner loops of foreign bodies."""

from __future__ import annotations

import pytest

from mavstack.rotation import from_euler, to_euler
from mavstack.sim.motion.external import ActuatorDemand
from mavstack.sim.vehicle_types import DEFAULT_HOME, VehicleType
from mavstack.simulators.bodies.copter import Copter
from mavstack.simulators.foreign.loops import LOOPS, CopterLoops, PlaneLoops, RoverLoops
from mavstack.simulators.foreign.sample import ForeignSample


def sample(**changes):
    values = {
        "time": 0.0,
        "position": (0.0, 0.0, -10.0),
        "velocity": (0.0, 0.0, 0.0),
        "attitude": (1.0, 0.0, 0.0, 0.0),
        "rates": (0.0, 0.0, 0.0),
        "force": (0.0, 0.0, -9.8),
    }
    return ForeignSample(**values | changes)


def test_a_copter_holds_a_lean():
    copter, loops = Copter(), CopterLoops()
    state = copter.reset(DEFAULT_HOME, 0.0)
    for step in range(1000):
        seen = ForeignSample(
            step * 0.004,
            state.position,
            state.velocity,
            state.attitude,
            state.rates,
            state.specific_force,
        )
        motors = loops.step(seen, ActuatorDemand(0.15, -0.1, 0.0, 0.55, 0.0), 0.004)
        state = copter.step(motors, 0.004)
    assert to_euler(state.attitude)[:2] == pytest.approx((0.15, -0.1), abs=0.02)


def test_the_hover_share_is_learned():
    loops = CopterLoops()
    for _ in range(2000):  # a body that needs 0.3 of its thrust
        motors = loops.step(sample(force=(0.0, 0.0, -9.80665)), ActuatorDemand(0, 0, 0, 0.3, 0), 0.01)
    assert sum(motors) / 4 == pytest.approx(0.6 * loops._hover, abs=0.01)
    assert loops._hover < 0.45


def test_surfaces_move_against_errors():
    loops = PlaneLoops()
    aileron, elevator, throttle, _ = loops.step(sample(), ActuatorDemand(0.3, 0.2, 0.0, 0.0, 0.7), 0.01)
    assert aileron > 0.1
    assert elevator > 0.1
    assert throttle == 0.7
    assert loops.pulses([1.0, -1.0, 0.5, 0.0]) == [2000, 1000, 1500, 1500]


def test_steering_reverses_backwards():
    loops = RoverLoops()
    ahead = loops.step(sample(velocity=(3.0, 0.0, 0.0)), ActuatorDemand(0, 0, 0.5, 0, 0.4), 0.01)
    back = loops.step(
        sample(velocity=(-3.0, 0.0, 0.0), rates=(0.0, 0.0, 0.5)), ActuatorDemand(0, 0, 0.5, 0, -0.4), 0.01
    )
    assert ahead[0] > 0.0 > back[0]
    assert loops.pulses([0.5, -0.5]) == [1750, 0, 1250]


@pytest.mark.parametrize("vehicle_type", list(LOOPS))
def test_outputs_stay_in_their_range(vehicle_type):
    loops = LOOPS[VehicleType(vehicle_type)]()
    wild = sample(attitude=from_euler(2.0, 1.0, -2.0), rates=(9.0, -9.0, 9.0), velocity=(50.0, -50.0, 9.0))
    outputs = loops.step(wild, ActuatorDemand(-1.0, 1.0, 3.0, 5.0, 3.0), 0.01)
    assert all(-1.0 <= value <= 1.0 for value in outputs)
    assert len(loops.stop()) == len(outputs)
