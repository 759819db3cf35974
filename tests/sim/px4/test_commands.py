"""Commands of PX4: every supported one acts, every other one is UNSUPPORTED."""

from __future__ import annotations

from collections.abc import Callable
from math import nan, radians
from typing import Any, TypeAlias

import pytest

from mavstack.dialects import ardupilotmega, common, development
from mavstack.services.mission import MissionItem
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.px4.harness import CMD, FIELD_ALTITUDE, RESULT, Px4Harness

LATITUDE, LONGITUDE = 47.3977418, 8.5455939
FRAME = common.MavFrame
#: Parameters of a command, and a check of its effect.
Case: TypeAlias = tuple[tuple[float, ...], Callable[[Px4Harness], bool]]


def request_case(message_type: Any, params: tuple[float, ...] | None = None) -> Case:
    """Return the case of a request for a message."""
    return params or (message_type.__mavlink_row__[0],), lambda harness: bool(
        harness.received_of(message_type)
    )


def attitude_is_slow(harness: Px4Harness) -> bool:
    before = len(harness.received_of(common.Attitude))
    harness.run(4.0)
    return 1 <= len(harness.received_of(common.Attitude)) - before <= 3


def servos(harness: Px4Harness) -> dict[int, int]:
    return dict(harness.autopilot.payload.servos)


def compass_is_calibrated(harness: Px4Harness) -> bool:
    harness.run(14.0)
    return harness.texts[-1] == "[cal] calibration done: mag"


def has_rebooted(harness: Px4Harness) -> bool:
    harness.run(2.0)
    return harness.vehicle.boots == 2


def gripper_has_closed(harness: Px4Harness) -> bool:
    harness.run(2.0)
    return (
        bool(harness.autopilot.payload.gripper_closed)
        and harness.result_of(CMD.DO_GRIPPER) == RESULT.ACCEPTED
    )


#: On the ground, disarmed.
ON_GROUND: dict[int, Case] = {
    CMD.NAV_RETURN_TO_LAUNCH: ((), lambda harness: harness.mode == "Return"),
    CMD.NAV_LAND: ((), lambda harness: harness.mode == "Land"),
    CMD.NAV_TAKEOFF: ((0, 0, 0, nan, nan, nan, 500), lambda harness: harness.mode == "Takeoff"),
    CMD.DO_SET_MODE: ((1, 4, 4), lambda harness: harness.mode == "Mission"),
    CMD.DO_SET_STANDARD_MODE: ((common.MavStandardMode.LAND,), lambda harness: harness.mode == "Land"),
    CMD.DO_CHANGE_SPEED: ((1, 3), lambda harness: harness.autopilot.maneuvers.speed == 3),
    CMD.DO_SET_HOME: (
        (0, 0, 0, 0, 47.4, 8.6, 500),
        lambda harness: harness.autopilot.home[:3] == pytest.approx((47.4, 8.6, 500)),
    ),
    CMD.DO_SET_ACTUATOR: (
        (0.5, nan, -1, nan, nan, nan, 0),
        lambda harness: servos(harness) == {9: 1750, 11: 1000},
    ),
    CMD.ACTUATOR_TEST: ((0.3, 2, 0, 0, 1), lambda harness: harness.autopilot.payload.motor_tested == 1),
    CMD.DO_SET_ROI_LOCATION: (
        (0, 0, 0, 0, LATITUDE, LONGITUDE + 0.001, 480),
        lambda harness: harness.autopilot.payload.region_of_interest is not None,
    ),
    CMD.DO_SET_ROI: (
        (3, 0, 0, 0, LATITUDE, LONGITUDE + 0.001, 480),
        lambda harness: harness.autopilot.payload.region_of_interest is not None,
    ),
    CMD.NAV_ROI: (
        (3, 0, 0, 0, LATITUDE, LONGITUDE + 0.001, 480),
        lambda harness: harness.autopilot.payload.region_of_interest is not None,
    ),
    CMD.DO_SET_ROI_NONE: ((), lambda harness: harness.autopilot.payload.region_of_interest is None),
    CMD.PREFLIGHT_CALIBRATION: ((0, 1), compass_is_calibrated),
    CMD.PREFLIGHT_STORAGE: ((2,), lambda harness: harness.vehicle.parameters["MPC_XY_CRUISE"] == 5.0),
    CMD.PREFLIGHT_REBOOT_SHUTDOWN: ((1,), has_rebooted),
    CMD.COMPONENT_ARM_DISARM: ((1,), lambda harness: harness.autopilot.armed),
    CMD.RUN_PREARM_CHECKS: ((), lambda harness: "Preflight Fail: heading estimate invalid" in harness.texts),
    CMD.INJECT_FAILURE: (
        (common.FailureUnit.SENSOR_GPS, common.FailureType.OFF),
        lambda harness: "gps" in harness.vehicle.faults.active,
    ),
    CMD.MISSION_START: ((), lambda harness: harness.mode == "Mission" and harness.autopilot.armed),
    CMD.DO_SET_MISSION_CURRENT: ((1,), lambda harness: harness.vehicle.mission.current == 1),
    CMD.GET_HOME_POSITION: request_case(common.HomePosition),
    CMD.GET_MESSAGE_INTERVAL: (
        (common.Attitude.__mavlink_row__[0],),
        lambda harness: bool(harness.received_of(common.MessageInterval)),
    ),
    CMD.SET_MESSAGE_INTERVAL: ((common.Attitude.__mavlink_row__[0], 2e6), attitude_is_slow),
    CMD.REQUEST_MESSAGE: request_case(common.AutopilotVersion),
    CMD.REQUEST_PROTOCOL_VERSION: request_case(common.ProtocolVersion, (1,)),
    CMD.REQUEST_AUTOPILOT_CAPABILITIES: request_case(common.AutopilotVersion, (1,)),
    CMD.REQUEST_FLIGHT_INFORMATION: request_case(common.FlightInformation, (1,)),
}
#: In the air, holding.
IN_THE_AIR: dict[int, Case] = {
    CMD.DO_REPOSITION: (
        (-1, 1, 0, radians(90), LATITUDE, LONGITUDE, FIELD_ALTITUDE + 30),
        lambda harness: harness.autopilot.target == pytest.approx((0, 0, -30), abs=1.0),
    ),
    CMD.DO_CHANGE_ALTITUDE: (
        (FIELD_ALTITUDE + 25, 0),
        lambda harness: harness.autopilot.target[2] == pytest.approx(-25, abs=0.1),
    ),
    CMD.DO_ORBIT: (
        (15, 2, 0, nan, LATITUDE, LONGITUDE, FIELD_ALTITUDE + 20),
        lambda harness: harness.mode == "Orbit",
    ),
    CMD.DO_LAND_START: (
        (),
        lambda harness: harness.mode == "Mission" and harness.vehicle.mission.current == 3,
    ),
    CMD.DO_FLIGHTTERMINATION: ((1,), lambda harness: harness.autopilot.terminated),
}
DELAYED: dict[int, Case] = {CMD.DO_GRIPPER: ((1, common.GripperActions.GRAB), gripper_has_closed)}


def prepare(harness: Px4Harness, command: int) -> None:
    """Prepare the state in which the effect of a command is visible."""
    if command in (CMD.MISSION_START, CMD.DO_LAND_START, CMD.DO_SET_MISSION_CURRENT):
        assert harness.upload(MISSION) == common.MavMissionResult.ACCEPTED
    elif command == CMD.DO_SET_ROI_NONE:
        harness.command(CMD.DO_SET_ROI_LOCATION, 0, 0, 0, 0, LATITUDE, LONGITUDE + 0.001, 480)
    elif command == CMD.PREFLIGHT_STORAGE:
        harness.vehicle.parameters.set("MPC_XY_CRUISE", 9.0)
    elif command == CMD.PREFLIGHT_CALIBRATION:
        harness.vehicle.faults.inject("compass 20")
    elif command == CMD.RUN_PREARM_CHECKS:
        harness.vehicle.faults.inject("compass 120")
        harness.run(10.0)
        harness.texts.clear()
    elif command == CMD.REQUEST_FLIGHT_INFORMATION:
        harness.received.clear()


POSITION: dict[str, Any] = {"frame": FRAME.GLOBAL_RELATIVE_ALT, "param5": LATITUDE, "param6": LONGITUDE}
MISSION = [
    MissionItem(CMD.NAV_TAKEOFF, param7=10.0, **POSITION),
    MissionItem(CMD.NAV_WAYPOINT, param7=12.0, **POSITION),
    MissionItem(CMD.DO_LAND_START, frame=FRAME.MISSION),
    MissionItem(CMD.NAV_LAND, param7=0.0, **POSITION),
]


@pytest.mark.fast_cases(5)
@pytest.mark.parametrize("command", sorted(ON_GROUND), ids=lambda command: CMD(command).name)
def test_command_on_the_ground_acts(command: int) -> None:
    harness = Px4Harness()
    prepare(harness, command)
    params, has_effect = ON_GROUND[command]
    assert harness.command(command, *params) == RESULT.ACCEPTED, harness.texts
    harness.run(0.4)
    assert has_effect(harness)


@pytest.mark.fast_cases(3)
@pytest.mark.parametrize("command", sorted(IN_THE_AIR), ids=lambda command: CMD(command).name)
def test_command_in_the_air_acts(command: int) -> None:
    harness = Px4Harness().take_off()
    prepare(harness, command)
    params, has_effect = IN_THE_AIR[command]
    assert harness.command(command, *params) == RESULT.ACCEPTED, harness.texts
    harness.run(0.4)
    assert has_effect(harness)


@pytest.mark.parametrize("command", sorted(DELAYED), ids=lambda command: CMD(command).name)
def test_command_in_progress_acts(command: int) -> None:
    harness = Px4Harness()
    params, has_effect = DELAYED[command]
    assert harness.command(command, *params) == RESULT.IN_PROGRESS
    assert has_effect(harness)


@pytest.mark.flight
def test_go_around() -> None:
    harness = Px4Harness().take_off(20)
    assert harness.command(CMD.DO_GO_AROUND) == RESULT.TEMPORARILY_REJECTED
    harness.command(CMD.NAV_LAND)
    harness.run(5.0)
    assert harness.command(CMD.DO_GO_AROUND) == RESULT.ACCEPTED
    harness.run_until(lambda: harness.height > 28)
    assert harness.mode == "Hold"


@pytest.mark.nightly
@pytest.mark.flight
def test_vtol_transition_and_back() -> None:
    harness = Px4Harness("vtol")
    assert harness.command(CMD.DO_VTOL_TRANSITION, common.MavVtolState.FW) == RESULT.TEMPORARILY_REJECTED
    harness.take_off(50)
    assert harness.command(CMD.DO_VTOL_TRANSITION, 9) == RESULT.DENIED
    assert harness.command(CMD.DO_VTOL_TRANSITION, common.MavVtolState.FW) == RESULT.ACCEPTED
    harness.run_until(lambda: harness.vehicle.body.transition > 0.98)
    assert harness.command(CMD.DO_VTOL_TRANSITION, common.MavVtolState.MC) == RESULT.ACCEPTED
    harness.run_until(lambda: harness.vehicle.body.transition < 0.02)
    assert abs(harness.height - 50) < 10


@pytest.mark.nightly
@pytest.mark.flight
def test_vtol_takeoff_continues_on_the_wing() -> None:
    harness = Px4Harness("vtol")
    altitude = FIELD_ALTITUDE + 60
    assert harness.command(CMD.NAV_VTOL_TAKEOFF, 0, 0, 0, nan, nan, nan, altitude) == RESULT.ACCEPTED
    harness.arm()
    harness.run_until(lambda: harness.mode == "Hold")
    assert harness.vehicle.body.transition > 0.9
    harness.run(10.0)
    assert abs(harness.height - 60) < 12


@pytest.mark.fast_cases(5)
@pytest.mark.parametrize("vehicle_type", list(VehicleType))
def test_all_other_commands_are_unsupported(vehicle_type: VehicleType) -> None:
    harness = Px4Harness(vehicle_type.value)
    supported = set(harness.vehicle.commands.supported)
    known = {
        *ON_GROUND,
        *IN_THE_AIR,
        *DELAYED,
        CMD.DO_GO_AROUND,
        CMD.DO_VTOL_TRANSITION,
        CMD.NAV_VTOL_TAKEOFF,
        development.MavCmd.EXTERNAL_WIND_ESTIMATE,  # tests/vehicle/external
        # These have tests of their own: test_log_streaming and telemetry/test_high_latency.
        *(CMD.LOGGING_START, CMD.LOGGING_STOP, CMD.CONTROL_HIGH_LATENCY),
    }
    assert supported <= known
    if vehicle_type is VehicleType.VTOL:
        assert supported == known
    for command in ardupilotmega.MavCmd:
        if command not in supported:
            assert harness.command(command) == RESULT.UNSUPPORTED, command


@pytest.mark.fast_cases(4)
@pytest.mark.parametrize("value", [nan, float("inf"), -1.0, 1e30, 70000.0])
@pytest.mark.parametrize("vehicle_type", ["copter", "vtol", "rover"])
def test_invalid_numbers_raise_no_error(vehicle_type: str, value: float) -> None:
    harness = Px4Harness(vehicle_type)
    for command in sorted(harness.vehicle.commands.supported):
        harness.command(command, *[value] * 7)
        harness.run(0.2)
    harness.run(2.0)
    assert harness.heartbeat[1] != (0, 0)
