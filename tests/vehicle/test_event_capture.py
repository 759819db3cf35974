"""The events of a PX4 vehicle in the errors of refused calls."""

from __future__ import annotations

import pickle

import pytest

from mavstack.errors import CommandDenied
from mavstack.sim import VehicleType
from mavstack.vehicle.event_capture import EventCapture
from tests.vehicle.world import ARDUPILOT, PX4, fly

REFUSED = "Arming refused until the failed checks pass"


@pytest.mark.parametrize("known", [True, False])
def test_a_refusal_of_px4_holds_its_events(known):
    async def scenario(world, vehicle):
        if known:
            await vehicle.component.download_event_metadata(cache=None)
        with pytest.raises(CommandDenied) as refused:
            await vehicle.arm()
        error = refused.value
        assert error.status_texts
        if known:
            assert error.events == (REFUSED,)
        else:
            assert error.events
            assert all("no metadata" in text for text in error.events)
        assert pickle.loads(pickle.dumps(error)).events == error.events
        error.status_texts = ()
        assert str(error).endswith(f"({'; '.join(error.events)})")

    fly((VehicleType.COPTER, PX4), scenario, ready=False)


def test_ardupilot_is_not_subscribed():
    async def scenario(world, vehicle):
        capture = EventCapture(vehicle.component)
        assert capture.take() == ()
        capture.close()

    fly((VehicleType.COPTER, ARDUPILOT), scenario)
