"""ROS 2 over DDS, with a reader and a writer whose types are those of Cyclone DDS itself."""

from __future__ import annotations

import asyncio
import time
from typing import Any

import pytest

from mavstack.bridges.core.inbound import MAX_AGE
from mavstack.bridges.ros2.dds_sink import DdsSink
from mavstack.sim.background import BackgroundSimulator
from tests.bridges.ros2.running import bridged, until

pytestmark = pytest.mark.interop
DOMAIN = 87


@pytest.mark.smoke
def test_topics_go_both_ways(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("cyclonedds")
    from tests.bridges.ros2.programs.dds_types import Float64, Twist, Vector3, participant, reader, writer

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")

    async def scenario(url: str) -> None:
        async with bridged(url, DdsSink(DOMAIN)) as (_, bridge):
            await until(lambda: not bridge._attaching)
            ours: Any = participant(DOMAIN)
            heading = reader(ours, "rt/mavros/global_position/compass_hdg", Float64)
            found: list[Any] = []
            await until(lambda: found.extend(heading.take(10)) or found)
            assert all(0.0 <= sample.data < 360.0 for sample in found if isinstance(sample, Float64))
            (inlet,) = (
                each
                for each in bridge.vehicles[1].inlets
                if each.name == "/mavros/setpoint_velocity/cmd_vel_unstamped"
            )
            velocity = writer(ours, f"rt{inlet.name}", Twist)
            await until(velocity.get_matched_subscriptions)
            velocity.write(Twist(Vector3(1.0, 0.0, 0.0), Vector3(0.0, 0.0, 0.1)))
            await until(lambda: inlet.accepted)
            velocity.write(Twist(Vector3(float("nan"), 0.0, 0.0), Vector3(0.0, 0.0, 0.0)))
            await until(lambda: inlet.refused)
            assert inlet.last_reason == "numbers must be finite"
            # A Twist has no header: its age is by the time that the middleware sends with it.
            held_back = time.time_ns() - 2 * MAX_AGE
            velocity.write(Twist(Vector3(1.0, 0.0, 0.0), Vector3(0.0, 0.0, 0.1)), held_back)
            await until(lambda: inlet.refused == 2)
            assert "later than others of its publisher" in inlet.last_reason

    with BackgroundSimulator() as simulator:
        asyncio.run(scenario(simulator.url))
