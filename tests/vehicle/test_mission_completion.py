"""The end of a mission of a vehicle that reports only the items that it reached."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace

import pytest

from mavstack.dialects import common
from mavstack.services.message_request.interval import message_id_of
from mavstack.services.mission import MissionItem
from mavstack.vehicle.mission_completion import END_DELAY, MissionCompletion
from mavstack.vehicle.vehicle_type import VehicleType
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT, CMD, run_scenario
from tests.vehicle.firmware.received_requests import HERE


class Flight:
    """A copter that flies a mission of five items, whose last one is a return."""

    def __init__(self, progress=None) -> None:
        self.time = 100.0
        self.vehicle = SimpleNamespace(
            armed=True,
            mode="AUTO",
            landed_state=common.MavLandedState.IN_AIR,
            vehicle_type=VehicleType.COPTER,
            connection=self,
        )
        firmware = SimpleNamespace(
            modes_of={"mission": frozenset({"auto", "rtl"})}.get,
            lands_in=lambda mode: mode == "RTL",
        )
        self.mission = SimpleNamespace(progress=progress, last_seq=4, landing_seq=4)
        self.completion = MissionCompletion(self.vehicle, firmware, self.mission)

    def now(self) -> float:
        return self.time


def test_the_current_item_is_the_one_after_the_last_reached() -> None:
    flight = Flight()
    assert flight.completion.remaining() is None
    assert not flight.completion.update([])
    assert not flight.completion.update([1, 2])
    assert flight.completion.remaining() == 2.0
    assert not flight.completion.update([3])
    assert flight.completion.remaining() == 1.0


@pytest.mark.parametrize("last", [[], [4]])
def test_a_disarmed_copter_has_flown_its_return(last) -> None:
    """ArduCopter 4.1 reports the return as reached when it is disarmed."""
    flight = Flight()
    assert not flight.completion.update([1, 2, 3])
    flight.vehicle.armed = False
    flight.vehicle.landed_state = common.MavLandedState.ON_GROUND
    assert flight.completion.update(last)


def test_a_copter_that_is_disarmed_before_its_return_was_interrupted() -> None:
    flight = Flight()
    assert not flight.completion.update([1])
    flight.vehicle.armed = False
    assert not flight.completion.update([])


def test_a_last_item_in_the_air_ends_after_a_delay() -> None:
    flight = Flight()
    assert not flight.completion.update([1, 2, 3, 4])
    flight.time += END_DELAY
    assert flight.completion.update([])


def test_flying_a_mission_requests_its_progress() -> None:
    """ArduCopter streams nothing by default."""

    async def scenario(harness):
        await harness.vehicle.mission.upload([MissionItem.takeoff(*HERE, 10), MissionItem.return_to_launch()])
        flying = asyncio.create_task(harness.vehicle.mission.fly())
        await asyncio.sleep(20)  # after the upload its progress is fresh
        flying.cancel()
        rates = [
            message.param2
            for message in harness.autopilot.received
            if isinstance(message, common.CommandLong)
            and message.command == CMD.SET_MESSAGE_INTERVAL
            and message.param1 == message_id_of(common.MissionCurrent)
        ]
        assert rates[0] == 1_000_000

    run_scenario(scenario, autopilot=ARDUPILOT)
