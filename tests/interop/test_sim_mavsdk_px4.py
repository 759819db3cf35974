"""MAVSDK with simulated PX4: streams, shell, failure injection, reboot and termination."""

from __future__ import annotations

import pytest

from tests.interop.mavsdk_peer import mavsdk_object, needs_mavsdk
from tests.interop.simulated import simulated_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]

#: Values of `failure.FailureUnit` and `failure.FailureType`.
GPS, MOTOR, GYRO = 4, 101, 0
OK, OFF, GARBAGE = 0, 1, 3
SHELL = 10


async def test_a_shell() -> None:
    async with simulated_flight("copter", "px4") as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        for line, expected in {
            "ver all": "PX4 version",
            "param show MIS_TAKEOFF_ALT": "MIS_TAKEOFF_ALT",
            "commander status": "isarmed",
            "commander arm": "",
        }.items():
            received = await flight.ground.stream("shell", "subscribe_receive")
            await flight.call_ok("shell", "send", line, SHELL)
            output = ""
            while expected not in output.replace("_", "").lower() and expected not in output:
                output += (await received.get())["data"]
        await flight.wait_for_telemetry("armed", True)


async def test_sensor_and_time_messages_arrive_without_a_request() -> None:
    async with simulated_flight("copter", "px4") as flight:
        await flight.wait_for_telemetry("imu", lambda imu: imu["acceleration_frd"]["down_m_s2"] < -9)
        await flight.wait_for_telemetry("odometry", lambda odometry: odometry["time_usec"] > 0)
        await flight.wait_for_telemetry("unix_epoch_time", lambda time: time > 1.5e15)


async def test_failures() -> None:
    async with simulated_flight("copter", "px4") as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        await flight.call_ok("failure", "inject", GPS, OFF, 0)
        await flight.wait_for_telemetry("gps_info", lambda update: update["fix_type"] == "NO_FIX")
        await flight.wait_for_telemetry("health", lambda update: not update["is_global_position_ok"])
        await flight.wait_until(lambda: not flight.vehicle.autopilot.has_position)
        await flight.call_fails("COMMAND_DENIED", "action", "arm")
        await flight.call_ok("failure", "inject", GPS, OK, 0)
        await flight.wait_for_telemetry("health_all_ok", True)
        await flight.call_fails("UNSUPPORTED", "failure", "inject", GYRO, GARBAGE, 0)
        await flight.call_ok("action", "arm")
        await flight.call_ok("action", "takeoff")
        await flight.wait_until(lambda: flight.height > 2)
        await flight.call_ok("failure", "inject", MOTOR, OFF, 1)
        await flight.wait_until(lambda: flight.height < 0.2)


async def test_failures_must_be_allowed() -> None:
    async with simulated_flight("copter", "px4", SYS_FAILURE_EN=0) as flight:
        await flight.call_fails("DENIED|DISABLED", "failure", "inject", GPS, OFF, 0)


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
async def test_reboot_and_terminate(firmware: str) -> None:
    async with simulated_flight("copter", firmware) as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        boots = flight.vehicle.boots
        await flight.call_ok("action", "reboot")
        await flight.wait_until(lambda: flight.vehicle.boots == boots + 1)
        await flight.wait_until(lambda: flight.vehicle.uptime > 4)
        await flight.wait_for_telemetry("health_all_ok", True)
        if firmware == "ardupilot":
            await flight.call_fails("FAILED", "action", "takeoff")
        await flight.call_ok("action", "arm")
        await flight.call_fails("DENIED|FAILED", "action", "reboot")
        await flight.call_ok("action", "takeoff")
        await flight.wait_until(lambda: flight.height > 1.5)
        await flight.call_ok("action", "kill" if firmware == "px4" else "terminate")
        await flight.wait_for_telemetry("armed", False)
        await flight.wait_until(lambda: flight.height < 0.2)


@pytest.mark.parametrize("vehicle_type", ["copter", "vtol", "rover", "boat", "sub"])
async def test_offboard_starts_right_after_the_first_setpoint(vehicle_type: str) -> None:
    async with simulated_flight(vehicle_type, "px4") as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        await flight.call_ok("action", "arm")
        if flight.vehicle.vehicle_type.flies:
            await flight.call_ok("action", "takeoff")
            await flight.wait_until(lambda: flight.height > 1.5)
        flight.runner.speed = 1.0
        for _ in range(5):
            still = mavsdk_object(
                "offboard.VelocityNedYaw", north_m_s=0.0, east_m_s=0.0, down_m_s=0.0, yaw_deg=0.0
            )
            await flight.call_ok("offboard", "set_velocity_ned", still)
            await flight.call_ok("offboard", "start")
            await flight.wait_for_telemetry("flight_mode", "OFFBOARD")
            await flight.call_ok("offboard", "stop")
            await flight.wait_until(lambda: flight.vehicle.autopilot.mode.name != "Offboard")
