"""The events of a simulated vehicle; the other members are tested with the values that they return."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.services.events import LogLevel
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.running import reduce_telemetry
from tests.vehicle.world import PX4, fly

PX4_COPTER = (VehicleType.COPTER, PX4)


@pytest.mark.flight
def test_events_of_a_vehicle_over_a_lossy_link():
    async def scenario(world, vehicle):
        heard, others = [], []
        vehicle.add_event_listener(lambda event: heard.append(event.name))
        vehicle.add_event_listener(others.append, component=100)
        async with vehicle.events(severity=LogLevel.INFO) as events:
            for _ in range(4):
                await vehicle.arm()
                await vehicle.disarm()
            found = [await anext(events) for _ in range(8)]
        armed, disarmed = found[:2]
        assert (armed.message, armed.severity) == ("Armed, reason: external command", LogLevel.INFO)
        assert armed.arguments == {"reason": "command_external"}
        assert disarmed.name == "px4::commander_disarmed_by"
        assert [event.name for event in found] == [armed.name, disarmed.name] * 4
        await asyncio.sleep(0.1)
        assert (heard, others) == ([event.name for event in found], [])
        texts = [text for text in vehicle.status_texts if text.text == "Armed by external command"]
        assert texts
        assert all(text.has_event for text in texts)

    fly(PX4_COPTER, scenario, prepare=reduce_telemetry, loss=0.1, latency=0.02)
