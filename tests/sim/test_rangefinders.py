from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.message_request.interval import message_id_of
from mavstack.sim import Obstacle, Rangefinder
from tests.sim.harness import AnyMessage, SimulationHarness, VehicleHarness

if TYPE_CHECKING:
    from collections.abc import Sequence

ORIENTATION, KIND = common.MavSensorOrientation, common.MavDistanceSensor
TREE = Obstacle(10.0, 0.0, 2.0)


def vehicle(
    firmware: str, finders: Sequence[str] = (), *, obstacle: Obstacle | None = TREE, **parameters: float
) -> VehicleHarness:
    """Return a copter in the air at home, which faces north."""
    harness = SimulationHarness()
    if obstacle is not None:
        harness.simulation.add_obstacle(obstacle)
    added = harness.simulation.add(
        "copter", firmware, rangefinders=[Rangefinder.parse(text) for text in finders]
    )
    one = harness.attach(VehicleHarness(harness, added)).set(**parameters)
    one.run(3)
    one.place_in_air()
    one.receiving = bool(one.port)
    one.run(0.1)
    return one


def requested(one: VehicleHarness, message: type[AnyMessage]) -> list[AnyMessage]:
    """Return the answer to one request of a message."""
    one.without_telemetry()
    one.received.clear()
    one.command(common.MavCmd.REQUEST_MESSAGE, message_id_of(message))
    return one.received_of(message)


def test_names():
    sonar = Rangefinder.parse("downward:sonar")
    assert (sonar.orientation, sonar.kind) == (ORIENTATION.PITCH_270, KIND.ULTRASOUND)
    assert sonar.name == "downward sonar"
    assert Rangefinder.parse("Forward").kind == KIND.LASER
    for text in ("", "down", "forward:eyes", ":sonar"):
        with pytest.raises(InvalidArgumentError, match="ORIENTATION"):
            Rangefinder.parse(text)


def test_impossible_rangefinders():
    with pytest.raises(InvalidArgumentError, match="looks"):
        Rangefinder(ORIENTATION.ROLL_90)
    with pytest.raises(InvalidArgumentError, match="range"):
        Rangefinder(min_distance=5.0, max_distance=1.0)
    with pytest.raises(InvalidArgumentError, match="at most 6"):
        SimulationHarness().simulation.add(rangefinders=[Rangefinder()] * 7)


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_each_rangefinder_measures_along_its_axis(firmware):
    one = vehicle(firmware, ["downward", "downward:sonar", "forward", "backward:radar"])
    sensors = requested(one, common.DistanceSensor)
    assert [each.id for each in sensors] == [0, 1, 2, 3]
    assert sensors[0].current_distance == pytest.approx(2000, abs=30)
    assert (sensors[1].type, sensors[1].orientation) == (KIND.ULTRASOUND, ORIENTATION.PITCH_270)
    assert sensors[1].current_distance == sensors[1].max_distance + 1  # too high for a sonar
    assert sensors[2].orientation == ORIENTATION.NONE
    assert sensors[2].current_distance == pytest.approx(800, abs=30)
    assert sensors[3].current_distance == sensors[3].max_distance + 1


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_distance_messages_are_sent_unasked(firmware):
    one = vehicle(firmware, ["forward"])
    one.received.clear()
    one.run(4)
    assert len(one.received_of(common.DistanceSensor)) >= 2
    assert len(one.received_of(common.ObstacleDistance)) >= 3


def test_a_rangefinder_whose_type_is_0_is_off():
    one = vehicle("ardupilot", ["downward", "forward"], RNGFND1_TYPE=0)
    assert [each.id for each in requested(one, common.DistanceSensor)] == [1]


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_sectors_of_the_proximity_sensor(firmware):
    message = requested(vehicle(firmware), common.ObstacleDistance)[0]
    assert message.frame == common.MavFrame.BODY_FRD
    assert (message.increment, len(message.distances)) == (5, 72)
    assert message.distances[0] == pytest.approx(800, abs=30)
    assert message.distances[1] > message.distances[0]
    assert message.distances[18] == message.max_distance + 1  # nothing in the east
    assert sum(each <= message.max_distance for each in message.distances) in (5, 6)


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_no_obstacle_no_proximity_sensor(firmware):
    one = vehicle(firmware, obstacle=None)
    one.run(3)
    assert not one.received_of(common.ObstacleDistance)
    assert requested(one, common.ObstacleDistance) == []
    assert one.vehicle.parameters.get("PRX1_TYPE", 0) == 0
