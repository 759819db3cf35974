"""MAVSDK flies simulated copters of both firmwares."""

from __future__ import annotations

import json
from math import radians

import pytest

from mavstack.dialects import common
from tests.interop.mavsdk_peer import mavsdk_object, needs_mavsdk
from tests.interop.simulated import simulated_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]

FIRMWARES = ("ardupilot", "px4")
#: Slow enough that MAVSDK's 20 setpoints per real second count as a stream, on a busy machine too.
SPEED_WITH_SETPOINTS = 2.0
#: MAVSDK's name of the guided mode, and its results of refusals.
GUIDED = {"ardupilot": "OFFBOARD", "px4": "HOLD"}
NOT_ARMED = {"ardupilot": "FAILED", "px4": "COMMAND_DENIED"}
REFUSAL_TEXTS = {"ardupilot": "Arm: ", "px4": "Preflight Fail: "}


@pytest.mark.parametrize("firmware", FIRMWARES)
async def test_copter_actions(firmware: str) -> None:
    async with simulated_flight("copter", firmware) as flight:
        await check_health(flight, firmware)
        await check_arming_refused_without_position(flight, firmware)
        await take_off(flight, firmware)
        await fly_to_locations(flight, firmware)
        await orbit_and_hold(flight, firmware)
        await return_to_launch(flight)
        await take_off_and_land(flight, firmware)


async def check_health(flight, firmware: str) -> None:
    assert await flight.call("system", "autopilot_type") == firmware.upper()
    assert await flight.call("system", "vehicle_type") == "MULTICOPTER"
    await flight.wait_for_telemetry("health_all_ok", True)
    await flight.wait_for_telemetry("health", lambda health: all(health.values()))
    await flight.call_ok("telemetry", "set_rate_landed_state", 2.0)
    await flight.wait_for_telemetry("in_air", False)


async def check_arming_refused_without_position(flight, firmware: str) -> None:
    texts = await flight.ground.stream("telemetry", "subscribe_status_text")
    if firmware == "ardupilot":  # ArduPilot checks the position only in a mode that needs it
        await flight.call_fails("FAILED", "action", "takeoff")
        assert flight.vehicle.autopilot.mode.name == "GUIDED"
    flight.vehicle.faults.inject("gps off")
    await flight.wait_until(lambda: not flight.vehicle.autopilot.has_position)
    await flight.call_fails(NOT_ARMED[firmware], "action", "arm")
    await texts.wait_for(lambda update: update["text"].startswith(REFUSAL_TEXTS[firmware]))
    await flight.wait_for_telemetry("health_all_ok", False)
    flight.vehicle.faults.inject("gps on")
    await flight.wait_for_telemetry("health_all_ok", True)
    await flight.wait_for_telemetry("armed", False)


async def take_off(flight, firmware: str) -> None:
    await flight.call_ok("action", "set_takeoff_altitude", 12.0)
    assert await flight.call("action", "get_takeoff_altitude") == 12.0
    await flight.call_ok("action", "arm")
    await flight.call_ok("action", "takeoff")
    await flight.wait_for_telemetry("landed_state", "TAKING_OFF")
    await flight.wait_until(lambda: flight.height > 11)
    await flight.wait_for_telemetry("landed_state", "IN_AIR")
    await flight.wait_for_telemetry("in_air", True)
    await flight.wait_for_telemetry("flight_mode", GUIDED[firmware])
    await flight.wait_until(lambda: abs(flight.height - 12) < 1)
    await flight.call_fails(NOT_ARMED[firmware], "action", "disarm")
    assert flight.vehicle.autopilot.armed


async def fly_to_locations(flight, firmware: str) -> None:
    latitude, longitude, altitude = flight.place(40, 10, 16)
    await flight.call_ok("action", "goto_location", latitude, longitude, altitude, 90.0)
    await flight.call_ok("action", "set_current_speed", 8.0)
    await flight.wait_until(lambda: flight.speed > 5)
    assert flight.speed < 9
    await flight.wait_for_telemetry(
        "position",
        lambda update: (
            update["latitude_deg"] == pytest.approx(latitude, abs=3e-5)
            and update["longitude_deg"] == pytest.approx(longitude, abs=3e-5)
            and update["relative_altitude_m"] == pytest.approx(16, abs=1.5)
        ),
    )
    assert flight.distance(40, 10) < 6
    if firmware == "px4":  # ArduPilot ignores the yaw
        await flight.wait_until(lambda: abs(flight.vehicle.body.truth.yaw - radians(90)) < 0.1)
        await flight.wait_for_telemetry("heading", lambda update: abs(update["heading_deg"] - 90) < 6)


async def orbit_and_hold(flight, firmware: str) -> None:
    orbit = ("action", "do_orbit", 15.0, 4.0, 0, *flight.place(40, 10, 16))
    if firmware == "px4":
        await flight.call_ok(*orbit)
        await flight.wait_until(lambda: abs(flight.distance(40, 10) - 15) < 2 and flight.speed > 3)
        await flight.fly(10)
        assert flight.distance(40, 10) == pytest.approx(15, abs=2)
        assert flight.speed == pytest.approx(4, abs=1)
    else:
        await flight.call_fails("UNSUPPORTED", *orbit)
    await flight.call_ok("action", "hold")
    await flight.wait_until(lambda: flight.vehicle.autopilot.mode.name in ("Hold", "BRAKE"))
    await flight.wait_until(lambda: flight.speed < 0.6)


async def return_to_launch(flight) -> None:
    await flight.call_ok("action", "set_return_to_launch_altitude", 20.0)
    assert await flight.call("action", "get_return_to_launch_altitude") == 20.0
    await flight.call_ok("action", "return_to_launch")
    await flight.wait_for_telemetry("flight_mode", "RETURN_TO_LAUNCH")
    await flight.wait_until(lambda: flight.height > 18)
    await flight.wait_until(lambda: flight.distance() < 2)
    await flight.wait_for_telemetry("landed_state", "LANDING", "ON_GROUND")
    await flight.wait_for_telemetry("armed", False)
    assert flight.distance() < 3


async def take_off_and_land(flight, firmware: str) -> None:
    if firmware == "ardupilot":  # MAVSDK would arm in BRAKE, which does not allow arming
        await flight.call_fails("FAILED", "action", "takeoff")
        await flight.wait_for_telemetry("flight_mode", "OFFBOARD")
    await flight.call_ok("action", "arm")
    await flight.call_ok("action", "takeoff")
    await flight.wait_until(lambda: flight.height > 5)
    await flight.call_ok("action", "land")
    await flight.wait_for_telemetry("flight_mode", "LAND")
    await flight.wait_for_telemetry("in_air", False)
    await flight.wait_for_telemetry("armed", False)


@pytest.mark.parametrize("firmware", FIRMWARES)
async def test_copter_offboard_setpoints(firmware: str) -> None:
    parameters = {"px4": {"COM_OF_LOSS_T": 5.0}, "ardupilot": {}}[firmware]
    async with simulated_flight("copter", firmware, **parameters) as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        await flight.call_ok("action", "set_takeoff_altitude", 8.0)
        await flight.call_ok("action", "arm")
        await flight.call_ok("action", "takeoff")
        await flight.wait_until(lambda: flight.height > 7)
        flight.runner.speed = SPEED_WITH_SETPOINTS
        await flight.call_fails("NO_SETPOINT_SET", "offboard", "start")
        position = mavsdk_object(
            "offboard.PositionNedYaw", north_m=6.0, east_m=-3.0, down_m=-9.0, yaw_deg=45.0
        )
        await flight.call_ok("offboard", "set_position_ned", position)
        await flight.call_ok("offboard", "start")
        await flight.wait_for_telemetry("flight_mode", "OFFBOARD")
        assert await flight.call("offboard", "is_active")
        await flight.wait_until(lambda: flight.distance(6, -3) < 1.5 and abs(flight.height - 9) < 1)
        await flight.wait_until(lambda: abs(flight.vehicle.body.truth.yaw - radians(45)) < 0.1)
        await check_velocity_setpoints(flight)
        await check_position_and_attitude_setpoints(flight)
        await flight.call_ok("offboard", "stop")
        await flight.wait_for_telemetry("flight_mode", "HOLD")
        await flight.wait_until(lambda: flight.speed < 0.6)


async def check_velocity_setpoints(flight) -> None:
    """Velocities in the local NED and the body frame."""
    velocity = mavsdk_object(
        "offboard.VelocityNedYaw", north_m_s=-3.0, east_m_s=2.0, down_m_s=-0.5, yaw_deg=90.0
    )
    await flight.call_ok("offboard", "set_velocity_ned", velocity)
    await flight.wait_for_telemetry(
        "velocity_ned",
        lambda update: (
            (update["north_m_s"], update["east_m_s"], update["down_m_s"])
            == pytest.approx((-3, 2, -0.5), abs=0.4)
        ),
    )
    await flight.wait_until(lambda: abs(flight.vehicle.body.truth.yaw - radians(90)) < 0.1)
    forward = mavsdk_object(
        "offboard.VelocityBodyYawspeed", forward_m_s=3.0, right_m_s=0.0, down_m_s=0.0, yawspeed_deg_s=0.0
    )
    await flight.call_ok("offboard", "set_velocity_body", forward)
    await flight.wait_for_telemetry(
        "velocity_ned",
        lambda update: (update["north_m_s"], update["east_m_s"]) == pytest.approx((0, 3), abs=0.6),
    )


async def check_position_and_attitude_setpoints(flight) -> None:
    latitude, longitude, _ = flight.place(0, 0)
    place = mavsdk_object(
        "offboard.PositionGlobalYaw",
        lat_deg=latitude,
        lon_deg=longitude,
        alt_m=10.0,
        yaw_deg=0.0,
        altitude_type=0,
    )
    await flight.call_ok("offboard", "set_position_global", place)
    await flight.wait_until(lambda: flight.distance() < 2 and abs(flight.height - 10) < 1.5)
    attitude = mavsdk_object("offboard.Attitude", roll_deg=10.0, pitch_deg=0.0, yaw_deg=0.0, thrust_value=0.5)
    await flight.call_ok("offboard", "set_attitude", attitude)
    await flight.wait_for_telemetry(
        "attitude_euler", lambda update: update["roll_deg"] == pytest.approx(10, abs=2)
    )
    await flight.wait_until(lambda: flight.vehicle.body.truth.velocity_east > 1)


async def test_px4_offboard_needs_a_setpoint_stream() -> None:
    async with simulated_flight("copter", "px4") as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        await flight.call_ok("action", "arm")
        await flight.call_ok("action", "takeoff")
        await flight.wait_for_telemetry("flight_mode", "HOLD")
        flight.runner.speed = SPEED_WITH_SETPOINTS
        offboard = {"command": int(common.MavCmd.DO_SET_MODE), "param1": 209.0, "param2": 6.0}
        acks = await flight.ground.stream("mavlink_direct", "subscribe_message", "COMMAND_ACK")
        await flight.call_ok("mavlink_direct", "send_message", direct_message("COMMAND_LONG", offboard))
        ack = await acks.wait_for(lambda update: command_id(update) == offboard["command"])
        assert json.loads(ack["fields_json"])["result"] == common.MavResult.TEMPORARILY_REJECTED
        still = mavsdk_object(
            "offboard.VelocityNedYaw", north_m_s=0.0, east_m_s=0.0, down_m_s=0.0, yaw_deg=0.0
        )
        await flight.call_ok("offboard", "set_velocity_ned", still)
        await flight.call_ok("offboard", "start")
        await flight.wait_for_telemetry("flight_mode", "OFFBOARD")
        # Setpoints stop with the ground station.
        await flight.ground.close()
        await flight.wait_until(lambda: "Failsafe activated" in flight.texts)
        assert flight.vehicle.autopilot.mode.name == "Return"


def direct_message(name: str, fields: dict) -> dict:
    """Return a message for the mavlink_direct plugin."""
    target = {"target_system": 1, "target_component": 1}
    return mavsdk_object(
        "mavlink_direct.MavlinkMessage",
        message_name=name,
        system_id=245,
        component_id=190,
        target_system_id=1,
        target_component_id=1,
        fields_json=json.dumps(target | fields),
    )


def command_id(update: dict) -> int:
    return json.loads(update["fields_json"])["command"]
