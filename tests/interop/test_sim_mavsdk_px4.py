"""MAVSDK and what only our simulated PX4 has: its shell, failures on demand; and the ends of flights."""

from __future__ import annotations

import pytest

from tests.interop.mavsdk_peer import needs_mavsdk
from tests.interop.simulated import in_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]

#: Of `failure.FailureUnit` and `failure.FailureType`.
GPS, MOTOR, GYRO = 4, 101, 0
OK, OFF, GARBAGE = 0, 1, 3
SHELL = 10


async def test_a_shell() -> None:
    async with in_flight("copter", "px4") as flight:
        await flight.hears("health_all_ok", True)
        for line, wanted in {
            "ver all": "PX4 version",
            "param show MIS_TAKEOFF_ALT": "MIS_TAKEOFF_ALT",
            "commander status": "isarmed",
            "commander arm": "",
        }.items():
            received = await flight.ground.stream("shell", "subscribe_receive")
            await flight.does("shell", "send", line, SHELL)
            said = ""
            while wanted not in said.replace("_", "").lower() and wanted not in said:
                said += (await received.get())["data"]
        await flight.hears("armed", True)


async def test_failures() -> None:
    async with in_flight("copter", "px4") as flight:
        await flight.hears("health_all_ok", True)
        await flight.does("failure", "inject", GPS, OFF, 0)
        await flight.hears("gps_info", lambda heard: heard["fix_type"] == "NO_FIX")
        await flight.hears("health", lambda heard: not heard["is_global_position_ok"])
        await flight.until(lambda: not flight.vehicle.autopilot.has_position)
        await flight.refuses("COMMAND_DENIED", "action", "arm")
        await flight.does("failure", "inject", GPS, OK, 0)
        await flight.hears("health_all_ok", True)
        await flight.refuses("UNSUPPORTED", "failure", "inject", GYRO, GARBAGE, 0)
        await flight.does("action", "arm")
        await flight.does("action", "takeoff")
        await flight.until(lambda: flight.height > 2)
        await flight.does("failure", "inject", MOTOR, OFF, 1)
        await flight.until(lambda: flight.height < 0.2)


async def test_failures_must_be_allowed() -> None:
    async with in_flight("copter", "px4", SYS_FAILURE_EN=0) as flight:
        await flight.refuses("DENIED|DISABLED", "failure", "inject", GPS, OFF, 0)


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
async def test_the_end_of_a_flight(firmware: str) -> None:
    async with in_flight("copter", firmware) as flight:
        await flight.hears("health_all_ok", True)
        boots = flight.vehicle.boots
        await flight.does("action", "reboot")
        await flight.until(lambda: flight.vehicle.boots == boots + 1)
        await flight.until(lambda: flight.vehicle.uptime > 4)
        await flight.hears("health_all_ok", True)
        if firmware == "ardupilot":
            await flight.refuses("FAILED", "action", "takeoff")
        await flight.does("action", "arm")
        await flight.refuses("DENIED|FAILED", "action", "reboot")
        await flight.does("action", "takeoff")
        await flight.until(lambda: flight.height > 1.5)
        await flight.does("action", "kill" if firmware == "px4" else "terminate")
        await flight.hears("armed", False)
        await flight.until(lambda: flight.height < 0.2)
