"""The state of a vehicle: shortcuts to telemetry, its heartbeat, its events."""

from __future__ import annotations

import asyncio
from math import pi

import pytest

from mavstack.dialects import common
from mavstack.services.events import LogLevel
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.running import reduce_telemetry
from tests.vehicle.peers import TYPE, run_scenario
from tests.vehicle.world import PX4, fly

PX4_COPTER = (VehicleType.COPTER, PX4)


def test_shortcuts_to_telemetry():
    async def scenario(harness):
        await harness.add_peer(1, 1, uptime=None)
        vehicle = await harness.connection.wait_for_vehicle(1)

        async def values(*messages):
            for message in messages:
                harness.peers[0].node.send(message)
            await vehicle.wait_for_message(common.Heartbeat)
            return vehicle.heading, vehicle.ground_speed, vehicle.climb_rate

        assert await values() == (None, None, None)
        assert vehicle.info.type == TYPE.QUADROTOR
        assert await values(common.VfrHud(groundspeed=3.0, climb=1.5)) == (None, 3.0, 1.5)
        assert (await values(common.Attitude(yaw=pi / 2)))[0] == pytest.approx(90.0)
        moving = common.GlobalPositionInt(lat=1, lon=1, vx=300, vy=400, vz=-200, hdg=4500)
        assert await values(moving) == pytest.approx((45.0, 5.0, 2.0))

    run_scenario(scenario)


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
