"""MAVSDK flies our simulated copters, both firmwares', as a script of its users would."""

from __future__ import annotations

import json
from math import radians

import pytest

from mavstack.dialects import common
from tests.interop.mavsdk_peer import made, needs_mavsdk
from tests.interop.simulated import in_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]

FIRMWARES = ("ardupilot", "px4")
#: MAVSDK's twenty setpoints in a real second still are a stream for the vehicle, if the machine is busy, too.
SPEED_WITH_SETPOINTS = 2.0
#: What MAVSDK calls the modes, and what it says if they refuse.
GUIDED = {"ardupilot": "OFFBOARD", "px4": "HOLD"}
NOT_ARMED = {"ardupilot": "FAILED", "px4": "COMMAND_DENIED"}
WHY_NOT = {"ardupilot": "Arm: ", "px4": "Preflight Fail: "}


@pytest.mark.parametrize("firmware", FIRMWARES)
async def test_a_copter_flies_as_it_is_told(firmware: str) -> None:
    async with in_flight("copter", firmware) as flight:
        await becomes_healthy(flight, firmware)
        await refuses_to_arm_blind(flight, firmware)
        await takes_off(flight, firmware)
        await goes_where_it_is_told(flight, firmware)
        await circles_and_holds(flight, firmware)
        await comes_home(flight)
        await lands_where_it_is(flight, firmware)


async def becomes_healthy(flight, firmware: str) -> None:
    assert await flight.call("system", "autopilot_type") == firmware.upper()
    assert await flight.call("system", "vehicle_type") == "MULTICOPTER"
    await flight.hears("health_all_ok", True)
    await flight.hears("health", lambda health: all(health.values()))
    await flight.does("telemetry", "set_rate_landed_state", 2.0)
    await flight.hears("in_air", False)


async def refuses_to_arm_blind(flight, firmware: str) -> None:
    texts = await flight.ground.stream("telemetry", "subscribe_status_text")
    if firmware == "ardupilot":  # which looks at the position only in a mode that needs it
        await flight.refuses("FAILED", "action", "takeoff")
        assert flight.vehicle.autopilot.mode.name == "GUIDED"
    flight.vehicle.faults.inject("gps off")
    await flight.until(lambda: not flight.vehicle.autopilot.has_position)
    await flight.refuses(NOT_ARMED[firmware], "action", "arm")
    await texts.until(lambda heard: heard["text"].startswith(WHY_NOT[firmware]))
    await flight.hears("health_all_ok", False)
    flight.vehicle.faults.inject("gps on")
    await flight.hears("health_all_ok", True)
    await flight.hears("armed", False)


async def takes_off(flight, firmware: str) -> None:
    await flight.does("action", "set_takeoff_altitude", 12.0)
    assert await flight.call("action", "get_takeoff_altitude") == 12.0
    await flight.does("action", "arm")
    await flight.does("action", "takeoff")
    await flight.hears("landed_state", "TAKING_OFF")
    await flight.until(lambda: flight.height > 11)
    await flight.hears("landed_state", "IN_AIR")
    await flight.hears("in_air", True)
    await flight.hears("flight_mode", GUIDED[firmware])
    await flight.until(lambda: abs(flight.height - 12) < 1)
    await flight.refuses(NOT_ARMED[firmware], "action", "disarm")
    assert flight.vehicle.autopilot.armed


async def goes_where_it_is_told(flight, firmware: str) -> None:
    latitude, longitude, altitude = flight.place(40, 10, 16)
    await flight.does("action", "goto_location", latitude, longitude, altitude, 90.0)
    await flight.does("action", "set_current_speed", 8.0)
    await flight.until(lambda: flight.speed > 5)
    assert flight.speed < 9
    await flight.hears(
        "position",
        lambda heard: (
            heard["latitude_deg"] == pytest.approx(latitude, abs=3e-5)
            and heard["longitude_deg"] == pytest.approx(longitude, abs=3e-5)
            and heard["relative_altitude_m"] == pytest.approx(16, abs=1.5)
        ),
    )
    assert flight.distance(40, 10) < 6
    if firmware == "px4":  # ArduPilot does not look at the yaw
        await flight.until(lambda: abs(flight.vehicle.body.truth.yaw - radians(90)) < 0.1)
        await flight.hears("heading", lambda heard: abs(heard["heading_deg"] - 90) < 6)


async def circles_and_holds(flight, firmware: str) -> None:
    orbit = ("action", "do_orbit", 15.0, 4.0, 0, *flight.place(40, 10, 16))
    if firmware == "px4":
        await flight.does(*orbit)
        await flight.until(lambda: abs(flight.distance(40, 10) - 15) < 2 and flight.speed > 3)
        await flight.fly(10)
        assert flight.distance(40, 10) == pytest.approx(15, abs=2)
        assert flight.speed == pytest.approx(4, abs=1)
    else:
        await flight.refuses("UNSUPPORTED", *orbit)
    await flight.does("action", "hold")
    await flight.until(lambda: flight.vehicle.autopilot.mode.name in ("Hold", "BRAKE"))
    await flight.until(lambda: flight.speed < 0.6)


async def comes_home(flight) -> None:
    await flight.does("action", "set_return_to_launch_altitude", 20.0)
    assert await flight.call("action", "get_return_to_launch_altitude") == 20.0
    await flight.does("action", "return_to_launch")
    await flight.hears("flight_mode", "RETURN_TO_LAUNCH")
    await flight.until(lambda: flight.height > 18)
    await flight.until(lambda: flight.distance() < 2)
    await flight.hears("landed_state", "LANDING", "ON_GROUND")
    await flight.hears("armed", False)
    assert flight.distance() < 3


async def lands_where_it_is(flight, firmware: str) -> None:
    if firmware == "ardupilot":  # MAVSDK would arm in BRAKE, where one cannot
        await flight.refuses("FAILED", "action", "takeoff")
        await flight.hears("flight_mode", "OFFBOARD")
    await flight.does("action", "arm")
    await flight.does("action", "takeoff")
    await flight.until(lambda: flight.height > 5)
    await flight.does("action", "land")
    await flight.hears("flight_mode", "LAND")
    await flight.hears("in_air", False)
    await flight.hears("armed", False)


@pytest.mark.parametrize("firmware", FIRMWARES)
async def test_a_copter_by_setpoints(firmware: str) -> None:
    patience = {"px4": {"COM_OF_LOSS_T": 5.0}, "ardupilot": {}}[firmware]
    async with in_flight("copter", firmware, **patience) as flight:
        await flight.hears("health_all_ok", True)
        await flight.does("action", "set_takeoff_altitude", 8.0)
        await flight.does("action", "arm")
        await flight.does("action", "takeoff")
        await flight.until(lambda: flight.height > 7)
        flight.runner.speed = SPEED_WITH_SETPOINTS
        await flight.refuses("NO_SETPOINT_SET", "offboard", "start")
        position = made("offboard.PositionNedYaw", north_m=6.0, east_m=-3.0, down_m=-9.0, yaw_deg=45.0)
        await flight.does("offboard", "set_position_ned", position)
        await flight.does("offboard", "start")
        await flight.hears("flight_mode", "OFFBOARD")
        assert await flight.call("offboard", "is_active")
        await flight.until(lambda: flight.distance(6, -3) < 1.5 and abs(flight.height - 9) < 1)
        await flight.until(lambda: abs(flight.vehicle.body.truth.yaw - radians(45)) < 0.1)
        await velocities(flight)
        await places_and_attitudes(flight)
        await flight.does("offboard", "stop")
        await flight.hears("flight_mode", "HOLD")
        await flight.until(lambda: flight.speed < 0.6)


async def velocities(flight) -> None:
    """In axes of the ground and of the vehicle."""
    velocity = made("offboard.VelocityNedYaw", north_m_s=-3.0, east_m_s=2.0, down_m_s=-0.5, yaw_deg=90.0)
    await flight.does("offboard", "set_velocity_ned", velocity)
    await flight.hears(
        "velocity_ned",
        lambda heard: (
            (heard["north_m_s"], heard["east_m_s"], heard["down_m_s"])
            == pytest.approx((-3, 2, -0.5), abs=0.4)
        ),
    )
    await flight.until(lambda: abs(flight.vehicle.body.truth.yaw - radians(90)) < 0.1)
    forward = made(
        "offboard.VelocityBodyYawspeed", forward_m_s=3.0, right_m_s=0.0, down_m_s=0.0, yawspeed_deg_s=0.0
    )
    await flight.does("offboard", "set_velocity_body", forward)
    await flight.hears(
        "velocity_ned",
        lambda heard: (heard["north_m_s"], heard["east_m_s"]) == pytest.approx((0, 3), abs=0.6),
    )


async def places_and_attitudes(flight) -> None:
    latitude, longitude, _ = flight.place(0, 0)
    place = made(
        "offboard.PositionGlobalYaw",
        lat_deg=latitude,
        lon_deg=longitude,
        alt_m=10.0,
        yaw_deg=0.0,
        altitude_type=0,
    )
    await flight.does("offboard", "set_position_global", place)
    await flight.until(lambda: flight.distance() < 2 and abs(flight.height - 10) < 1.5)
    attitude = made("offboard.Attitude", roll_deg=10.0, pitch_deg=0.0, yaw_deg=0.0, thrust_value=0.5)
    await flight.does("offboard", "set_attitude", attitude)
    await flight.hears("attitude_euler", lambda heard: heard["roll_deg"] == pytest.approx(10, abs=2))
    await flight.until(lambda: flight.vehicle.body.truth.velocity_east > 1)


async def test_px4_wants_a_stream_of_setpoints_before_offboard() -> None:
    async with in_flight("copter", "px4") as flight:
        await flight.hears("health_all_ok", True)
        await flight.does("action", "arm")
        await flight.does("action", "takeoff")
        await flight.hears("flight_mode", "HOLD")
        flight.runner.speed = SPEED_WITH_SETPOINTS
        offboard = {"command": int(common.MavCmd.DO_SET_MODE), "param1": 209.0, "param2": 6.0}
        acks = await flight.ground.stream("mavlink_direct", "subscribe_message", "COMMAND_ACK")
        await flight.does("mavlink_direct", "send_message", to_vehicle("COMMAND_LONG", offboard))
        ack = await acks.until(lambda heard: command_of(heard) == offboard["command"])
        assert json.loads(ack["fields_json"])["result"] == common.MavResult.TEMPORARILY_REJECTED
        still = made("offboard.VelocityNedYaw", north_m_s=0.0, east_m_s=0.0, down_m_s=0.0, yaw_deg=0.0)
        await flight.does("offboard", "set_velocity_ned", still)
        await flight.does("offboard", "start")
        await flight.hears("flight_mode", "OFFBOARD")
        # The setpoints cease with the ground station.
        await flight.ground.close()
        await flight.until(lambda: "Failsafe activated" in flight.texts)
        assert flight.vehicle.autopilot.mode.name == "Return"


def to_vehicle(name: str, fields: dict) -> dict:
    """A message that MAVSDK sends as it is."""
    target = {"target_system": 1, "target_component": 1}
    return made(
        "mavlink_direct.MavlinkMessage",
        message_name=name,
        system_id=245,
        component_id=190,
        target_system_id=1,
        target_component_id=1,
        fields_json=json.dumps(target | fields),
    )


def command_of(heard: dict) -> int:
    return json.loads(heard["fields_json"])["command"]
