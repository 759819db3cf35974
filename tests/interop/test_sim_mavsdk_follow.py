"""MAVSDK's FollowMe plugin leads a simulated PX4."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.sim.px4.modes import FOLLOW_TARGET
from tests.interop.mavsdk_peer import mavsdk_object, needs_mavsdk
from tests.interop.simulated import simulated_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]

DISTANCE, HEIGHT = 10.0, 12.0


async def test_a_copter_follows_the_target_of_mavsdk() -> None:
    async with simulated_flight("copter", "px4") as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        await flight.call_ok("action", "arm")
        await flight.call_ok("action", "takeoff")
        await flight.wait_until(lambda: flight.height > 2)
        settings = mavsdk_object(
            "follow_me.Config", follow_height_m=HEIGHT, follow_distance_m=DISTANCE, responsiveness=0.5,
            altitude_mode=0, max_tangential_vel_m_s=8.0, follow_angle_deg=180.0,
        )  # fmt: skip
        await flight.call_ok("follow_me", "set_config", settings)
        latitude, longitude, altitude = flight.place(30.0, 0.0)
        target = mavsdk_object(
            "follow_me.TargetLocation", latitude_deg=latitude, longitude_deg=longitude,
            absolute_altitude_m=altitude, velocity_x_m_s=0.0, velocity_y_m_s=0.0, velocity_z_m_s=0.0,
        )  # fmt: skip
        with flight.real_time():  # MAVSDK repeats the target each second
            await flight.call_ok("follow_me", "start")
            await flight.wait_until(lambda: flight.vehicle.autopilot.mode.number == FOLLOW_TARGET)
            for _ in range(60):
                await flight.call_ok("follow_me", "set_target_location", target)
                if abs(flight.distance(30.0) - DISTANCE) < 2 and abs(flight.height - HEIGHT) < 1:
                    break
                await asyncio.sleep(0.5)
            assert flight.distance(30.0) == pytest.approx(DISTANCE, abs=2)
            assert flight.height == pytest.approx(HEIGHT, abs=1)
            await flight.call_ok("follow_me", "stop")
            await flight.wait_until(lambda: flight.vehicle.autopilot.mode.number != FOLLOW_TARGET)
