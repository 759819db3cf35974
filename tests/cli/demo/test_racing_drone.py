from __future__ import annotations

import pytest

from mavstack.cli.demo.racing_drone import add_racing_drone
from mavstack.sim import Simulation


def test_it_has_a_mission_that_repeats():
    controller = add_racing_drone(Simulation())
    mission = controller.system.mission
    assert mission.is_valid
    assert (mission.waypoints[-1].parameter_1, mission.waypoints[-1].parameter_2) == (1, -1)


@pytest.mark.flight
def test_its_transmitter_flies_the_mission():
    simulation = Simulation()
    controller = add_racing_drone(simulation)
    controller.body.recharge(0.1)
    simulation.advance(simulation.now + 16)
    assert (controller.armed, controller.mode) == (True, "NAV WP")
    assert controller.system.altitude == pytest.approx(15, abs=2)
    assert controller.body.battery.remaining > 0.9
