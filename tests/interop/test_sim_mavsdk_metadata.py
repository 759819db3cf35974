"""MAVSDK's component metadata with simulated PX4: it downloads the files of parameters and events."""

from __future__ import annotations

import json

import pytest

from mavstack.sim.event_metadata import event_metadata
from tests.interop.mavsdk_peer import needs_mavsdk
from tests.interop.simulated import simulated_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]

AUTOPILOT = 1
PARAMETER = (1, "PARAMETER")


async def test_parameters() -> None:
    async with simulated_flight("copter", "px4") as flight:
        updates = await flight.ground.stream("component_metadata", "subscribe_metadata_available")
        await flight.ground.call("component_metadata", "request_component", AUTOPILOT)
        update = await updates.wait_for(lambda update: update["type"] in PARAMETER)
        assert update["compid"] == AUTOPILOT
        found = {each["name"]: each for each in json.loads(update["json_metadata"])["parameters"]}
        assert len(found) == len(flight.vehicle.parameters)
        assert found["MPC_XY_CRUISE"]["max"] == 20


async def test_events() -> None:
    async with simulated_flight("copter", "px4") as flight:
        updates = await flight.ground.stream("component_metadata", "subscribe_metadata_available")
        await flight.ground.call("component_metadata", "request_component", AUTOPILOT)
        update = await updates.wait_for(lambda update: update["type"] == "EVENTS")
        assert json.loads(update["json_metadata"]) == json.loads(event_metadata())
