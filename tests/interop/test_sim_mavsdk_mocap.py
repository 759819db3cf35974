"""MAVSDK's Mocap plugin feeds the estimators of simulated vehicles, in each of its forms."""

from __future__ import annotations

import asyncio

import pytest

from tests.interop.mavsdk_peer import mavsdk_object, needs_mavsdk
from tests.interop.simulated import simulated_flight
from tests.sim.autopilot.test_external_vision import VISION

pytestmark = [pytest.mark.interop, needs_mavsdk]
UNKNOWN = mavsdk_object("mocap.Covariance", covariance_matrix=[float("nan")])


def vision(truth) -> tuple[str, dict]:
    """Return the call for VISION_POSITION_ESTIMATE."""
    place = mavsdk_object("mocap.PositionBody", x_m=truth.north, y_m=truth.east, z_m=truth.down)
    angles = mavsdk_object("mocap.AngleBody", roll_rad=0.0, pitch_rad=0.0, yaw_rad=truth.yaw)
    return "set_vision_position_estimate", mavsdk_object(
        "mocap.VisionPositionEstimate", time_usec=0, position_body=place, angle_body=angles,
        pose_covariance=UNKNOWN, reset_counter=0,
    )  # fmt: skip


def mocap(truth) -> tuple[str, dict]:
    """Return the call for ATT_POS_MOCAP."""
    place = mavsdk_object("mocap.PositionBody", x_m=truth.north, y_m=truth.east, z_m=truth.down)
    q = mavsdk_object("mocap.Quaternion", w=1.0, x=0.0, y=0.0, z=0.0)
    return "set_attitude_position_mocap", mavsdk_object(
        "mocap.AttitudePositionMocap", time_usec=0, q=q, position_body=place, pose_covariance=UNKNOWN
    )


@pytest.mark.parametrize(
    ("firmware", "form"),
    [("px4", vision), ("px4", mocap), ("ardupilot", vision)],
    ids=lambda value: getattr(value, "__name__", value),
)
async def test_estimates_of_mavsdk_are_used(firmware, form):
    settings = VISION[firmware] | ({"EKF2_EV_CTRL": 3} if firmware == "px4" else {"EK3_SRC1_YAW": 1})
    async with simulated_flight("copter", firmware, speed=1.0, **settings) as flight:
        flight.vehicle.body.fail_gps()
        flight.vehicle.reboot()
        await asyncio.sleep(2)
        for _ in range(60):
            method, estimate = form(flight.vehicle.body.truth)
            await flight.call_ok("mocap", method, estimate)
            found = flight.vehicle.autopilot.vision
            if found is not None and found.aids_position:
                break
            await asyncio.sleep(0.05)
        assert found.aids_position
