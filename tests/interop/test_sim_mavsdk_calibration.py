"""MAVSDK's calibration plugin with simulated vehicles; the plugin knows PX4's conversations only."""

from __future__ import annotations

import pytest

from tests.interop.mavsdk_peer import needs_mavsdk
from tests.interop.simulated import Flight, simulated_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]

#: Slow enough for MAVSDK to receive all status texts on a busy machine.
SPEED = 4.0
SIDES = ("back", "front", "left", "right", "up", "down")


async def calibrate(flight: Flight, kind: str) -> list[tuple[str, dict]]:
    """Run a calibration; return its results with their progress data, the final one last."""
    reports = await flight.ground.stream("calibration", f"calibrate_{kind}_async")
    received = [await reports.get()]
    while received[-1][0] == "NEXT":
        received.append(await reports.get())
    return received


def progress(received: list[tuple[str, dict]]) -> list[float]:
    """Return the progress values, 0 to 1, in the order received."""
    return [data["progress"] for result, data in received if result == "NEXT" and data["has_progress"]]


def instructions(received: list[tuple[str, dict]]) -> list[str]:
    """Return the texts for the person at the vehicle."""
    return [data["status_text"] for result, data in received if result == "NEXT" and data["has_status_text"]]


async def test_sensors_at_rest() -> None:
    async with simulated_flight("copter", "px4", speed=SPEED) as flight:
        for kind in ("gyro", "level_horizon"):
            received = await calibrate(flight, kind)
            assert received[-1][0] == "SUCCESS"
            shares = progress(received)
            assert shares == sorted(shares)
            assert (shares[0], shares[-1]) == (0.0, 1.0)
            await flight.fly(2)  # PX4 refuses the next one for a moment


@pytest.mark.parametrize("kind", ["accelerometer", "magnetometer"])
async def test_sensors_that_are_turned(kind: str) -> None:
    async with simulated_flight("copter", "px4", speed=SPEED) as flight:
        received = await calibrate(flight, kind)
        assert received[-1][0] == "SUCCESS"
        texts = instructions(received)
        assert texts[0] == f"pending: {' '.join(SIDES)}"
        for side in SIDES:
            assert f"{side} orientation detected" in texts
            assert f"{side} side done, rotate to a different side" in texts
        assert progress(received)[-1] > 0.9


async def test_cancel() -> None:
    async with simulated_flight("copter", "px4", speed=SPEED) as flight:
        reports = await flight.ground.stream("calibration", "calibrate_accelerometer_async")
        await reports.wait_for(lambda report: "orientation detected" in report[1]["status_text"])
        await flight.call_ok("calibration", "cancel")
        await reports.wait_for(lambda report: report[0] == "CANCELLED")
        await flight.fly(2)
        assert (await calibrate(flight, "gyro"))[-1][0] == "SUCCESS"


async def test_an_armed_vehicle_is_not_calibrated() -> None:
    async with simulated_flight("copter", "px4", speed=SPEED) as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        await flight.call_ok("action", "arm")
        await flight.wait_for_telemetry("armed", True)
        assert [result for result, _ in await calibrate(flight, "gyro")] == ["FAILED_ARMED"]


async def test_the_plugin_does_not_support_ardupilot() -> None:
    async with simulated_flight("copter", "ardupilot", speed=SPEED) as flight:
        assert [result for result, _ in await calibrate(flight, "gyro")] == ["UNSUPPORTED"]
