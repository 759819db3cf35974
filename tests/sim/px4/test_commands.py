"""Every command that PX4 takes acts, and every other is UNSUPPORTED."""

from __future__ import annotations

from collections.abc import Callable
from math import nan, radians
from typing import Any, TypeAlias

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.services.mission import MissionItem
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.px4.pilot import CMD, FIELD_ALTITUDE, RESULT, Pilot

LATITUDE, LONGITUDE = 47.3977418, 8.5455939
F = common.MavFrame
#: A command, and what shows that it acted.
Case: TypeAlias = tuple[tuple[float, ...], Callable[[Pilot], bool]]


def message(kind: Any, params: tuple[float, ...] | None = None) -> Case:
    """A request for a message."""
    return params or (kind.__mavlink_row__[0],), lambda pilot: bool(pilot.all_of(kind))


def slower(pilot: Pilot) -> bool:
    before = len(pilot.all_of(common.Attitude))
    pilot.run(4.0)
    return 1 <= len(pilot.all_of(common.Attitude)) - before <= 3


def servos(pilot: Pilot) -> dict[int, int]:
    return dict(pilot.autopilot.payload.servos)


def heals(pilot: Pilot) -> bool:
    pilot.run(4.0)
    return pilot.texts[-1] == "[cal] calibration done: mag"


def rebooted(pilot: Pilot) -> bool:
    pilot.run(2.0)
    return pilot.vehicle.boots == 2


def grabbed(pilot: Pilot) -> bool:
    pilot.run(2.0)
    return bool(pilot.autopilot.payload.gripper_closed) and pilot.result_of(CMD.DO_GRIPPER) == RESULT.ACCEPTED


#: On the ground, disarmed.
ON_GROUND: dict[int, Case] = {
    CMD.NAV_RETURN_TO_LAUNCH: ((), lambda pilot: pilot.mode == "Return"),
    CMD.NAV_LAND: ((), lambda pilot: pilot.mode == "Land"),
    CMD.NAV_TAKEOFF: ((0, 0, 0, nan, nan, nan, 500), lambda pilot: pilot.mode == "Takeoff"),
    CMD.DO_SET_MODE: ((1, 4, 4), lambda pilot: pilot.mode == "Mission"),
    CMD.DO_SET_STANDARD_MODE: ((common.MavStandardMode.LAND,), lambda pilot: pilot.mode == "Land"),
    CMD.DO_CHANGE_SPEED: ((1, 3), lambda pilot: pilot.autopilot.maneuvers.speed == 3),
    CMD.DO_SET_HOME: (
        (0, 0, 0, 0, 47.4, 8.6, 500),
        lambda pilot: pilot.autopilot.home[:3] == pytest.approx((47.4, 8.6, 500)),
    ),
    CMD.DO_SET_ACTUATOR: (
        (0.5, nan, -1, nan, nan, nan, 0),
        lambda pilot: servos(pilot) == {9: 1750, 11: 1000},
    ),
    CMD.ACTUATOR_TEST: ((0.3, 2, 0, 0, 1), lambda pilot: pilot.autopilot.payload.motor_tested == 1),
    CMD.DO_SET_ROI_LOCATION: (
        (0, 0, 0, 0, LATITUDE, LONGITUDE + 0.001, 480),
        lambda pilot: pilot.autopilot.payload.region_of_interest is not None,
    ),
    CMD.DO_SET_ROI: (
        (3, 0, 0, 0, LATITUDE, LONGITUDE + 0.001, 480),
        lambda pilot: pilot.autopilot.payload.region_of_interest is not None,
    ),
    CMD.NAV_ROI: (
        (3, 0, 0, 0, LATITUDE, LONGITUDE + 0.001, 480),
        lambda pilot: pilot.autopilot.payload.region_of_interest is not None,
    ),
    CMD.DO_SET_ROI_NONE: ((), lambda pilot: pilot.autopilot.payload.region_of_interest is None),
    CMD.PREFLIGHT_CALIBRATION: ((0, 1), heals),
    CMD.PREFLIGHT_STORAGE: ((2,), lambda pilot: pilot.vehicle.parameters["MPC_XY_CRUISE"] == 5.0),
    CMD.PREFLIGHT_REBOOT_SHUTDOWN: ((1,), rebooted),
    CMD.COMPONENT_ARM_DISARM: ((1,), lambda pilot: pilot.autopilot.armed),
    CMD.RUN_PREARM_CHECKS: ((), lambda pilot: "Preflight Fail: heading estimate invalid" in pilot.texts),
    CMD.INJECT_FAILURE: (
        (common.FailureUnit.SENSOR_GPS, common.FailureType.OFF),
        lambda pilot: "gps" in pilot.vehicle.faults.active,
    ),
    CMD.MISSION_START: ((), lambda pilot: pilot.mode == "Mission" and pilot.autopilot.armed),
    CMD.DO_SET_MISSION_CURRENT: ((1,), lambda pilot: pilot.vehicle.mission.current == 1),
    CMD.GET_HOME_POSITION: message(common.HomePosition),
    CMD.GET_MESSAGE_INTERVAL: (
        (common.Attitude.__mavlink_row__[0],),
        lambda pilot: bool(pilot.all_of(common.MessageInterval)),
    ),
    CMD.SET_MESSAGE_INTERVAL: ((common.Attitude.__mavlink_row__[0], 2e6), slower),
    CMD.REQUEST_MESSAGE: message(common.AutopilotVersion),
    CMD.REQUEST_PROTOCOL_VERSION: message(common.ProtocolVersion, (1,)),
    CMD.REQUEST_AUTOPILOT_CAPABILITIES: message(common.AutopilotVersion, (1,)),
    CMD.REQUEST_FLIGHT_INFORMATION: message(common.FlightInformation, (1,)),
}
#: In the air, holding.
IN_THE_AIR: dict[int, Case] = {
    CMD.DO_REPOSITION: (
        (-1, 1, 0, radians(90), LATITUDE, LONGITUDE, FIELD_ALTITUDE + 30),
        lambda pilot: pilot.autopilot.target == pytest.approx((0, 0, -30), abs=1.0),
    ),
    CMD.DO_CHANGE_ALTITUDE: (
        (FIELD_ALTITUDE + 25, 0),
        lambda pilot: pilot.autopilot.target[2] == pytest.approx(-25, abs=0.1),
    ),
    CMD.DO_ORBIT: (
        (15, 2, 0, nan, LATITUDE, LONGITUDE, FIELD_ALTITUDE + 20),
        lambda pilot: pilot.mode == "Orbit",
    ),
    CMD.DO_LAND_START: ((), lambda pilot: pilot.mode == "Mission" and pilot.vehicle.mission.current == 3),
    CMD.DO_FLIGHTTERMINATION: ((1,), lambda pilot: pilot.autopilot.terminated),
}
LATER: dict[int, Case] = {CMD.DO_GRIPPER: ((1, common.GripperActions.GRAB), grabbed)}


def prepared(pilot: Pilot, command: int) -> None:
    """What must be so before, that the effect can be seen."""
    if command in (CMD.MISSION_START, CMD.DO_LAND_START, CMD.DO_SET_MISSION_CURRENT):
        assert pilot.upload(MISSION) == common.MavMissionResult.ACCEPTED
    elif command == CMD.DO_SET_ROI_NONE:
        pilot.command(CMD.DO_SET_ROI_LOCATION, 0, 0, 0, 0, LATITUDE, LONGITUDE + 0.001, 480)
    elif command == CMD.PREFLIGHT_STORAGE:
        pilot.vehicle.parameters.set("MPC_XY_CRUISE", 9.0)
    elif command == CMD.PREFLIGHT_CALIBRATION:
        pilot.vehicle.faults.inject("compass 20")
    elif command == CMD.RUN_PREARM_CHECKS:
        pilot.vehicle.faults.inject("compass 120")
        pilot.run(10.0)
        pilot.texts.clear()
    elif command == CMD.REQUEST_FLIGHT_INFORMATION:
        pilot.heard.clear()


PLACE: dict[str, Any] = {"frame": F.GLOBAL_RELATIVE_ALT, "param5": LATITUDE, "param6": LONGITUDE}
MISSION = [
    MissionItem(CMD.NAV_TAKEOFF, param7=10.0, **PLACE),
    MissionItem(CMD.NAV_WAYPOINT, param7=12.0, **PLACE),
    MissionItem(CMD.DO_LAND_START, frame=F.MISSION),
    MissionItem(CMD.NAV_LAND, param7=0.0, **PLACE),
]


@pytest.mark.parametrize("command", sorted(ON_GROUND), ids=lambda command: CMD(command).name)
def test_a_command_on_the_ground_acts(command: int) -> None:
    pilot = Pilot()
    prepared(pilot, command)
    params, acted = ON_GROUND[command]
    assert pilot.command(command, *params) == RESULT.ACCEPTED, pilot.texts
    pilot.run(0.4)
    assert acted(pilot)


@pytest.mark.parametrize("command", sorted(IN_THE_AIR), ids=lambda command: CMD(command).name)
def test_a_command_in_the_air_acts(command: int) -> None:
    pilot = Pilot().in_the_air()
    prepared(pilot, command)
    params, acted = IN_THE_AIR[command]
    assert pilot.command(command, *params) == RESULT.ACCEPTED, pilot.texts
    pilot.run(0.4)
    assert acted(pilot)


@pytest.mark.parametrize("command", sorted(LATER), ids=lambda command: CMD(command).name)
def test_a_command_that_takes_a_while_acts(command: int) -> None:
    pilot = Pilot()
    params, acted = LATER[command]
    assert pilot.command(command, *params) == RESULT.IN_PROGRESS
    assert acted(pilot)


def test_a_landing_is_given_up() -> None:
    pilot = Pilot().in_the_air(20)
    assert pilot.command(CMD.DO_GO_AROUND) == RESULT.TEMPORARILY_REJECTED
    pilot.command(CMD.NAV_LAND)
    pilot.run(5.0)
    assert pilot.command(CMD.DO_GO_AROUND) == RESULT.ACCEPTED
    pilot.run_until(lambda: pilot.height > 28)
    assert pilot.mode == "Hold"


def test_a_vtol_changes_over_and_back() -> None:
    pilot = Pilot("vtol")
    assert pilot.command(CMD.DO_VTOL_TRANSITION, common.MavVtolState.FW) == RESULT.TEMPORARILY_REJECTED
    pilot.in_the_air(50)
    assert pilot.command(CMD.DO_VTOL_TRANSITION, 9) == RESULT.DENIED
    assert pilot.command(CMD.DO_VTOL_TRANSITION, common.MavVtolState.FW) == RESULT.ACCEPTED
    pilot.run_until(lambda: pilot.vehicle.body.transition > 0.98)
    assert pilot.command(CMD.DO_VTOL_TRANSITION, common.MavVtolState.MC) == RESULT.ACCEPTED
    pilot.run_until(lambda: pilot.vehicle.body.transition < 0.02)
    assert abs(pilot.height - 50) < 10


def test_a_vtol_takes_off_to_fly_forward() -> None:
    pilot = Pilot("vtol")
    altitude = FIELD_ALTITUDE + 60
    assert pilot.command(CMD.NAV_VTOL_TAKEOFF, 0, 0, 0, nan, nan, nan, altitude) == RESULT.ACCEPTED
    pilot.arm()
    pilot.run_until(lambda: pilot.mode == "Hold")
    assert pilot.vehicle.body.transition > 0.9
    pilot.run(10.0)
    assert abs(pilot.height - 60) < 12


@pytest.mark.parametrize("kind", list(VehicleType))
def test_these_cases_are_all_commands_and_every_other_is_unsupported(kind: VehicleType) -> None:
    pilot = Pilot(kind.value)
    taken = set(pilot.vehicle.commands.supported)
    known = {*ON_GROUND, *IN_THE_AIR, *LATER, CMD.DO_GO_AROUND, CMD.DO_VTOL_TRANSITION, CMD.NAV_VTOL_TAKEOFF}
    assert taken <= known
    if kind is VehicleType.VTOL:
        assert taken == known
    for command in ardupilotmega.MavCmd:
        if command not in taken:
            assert pilot.command(command) == RESULT.UNSUPPORTED, command


@pytest.mark.parametrize("value", [nan, float("inf"), -1.0, 1e30, 70000.0])
@pytest.mark.parametrize("kind", ["copter", "vtol", "rover"])
def test_senseless_numbers_do_no_harm(kind: str, value: float) -> None:
    pilot = Pilot(kind)
    for command in sorted(pilot.vehicle.commands.supported):
        pilot.command(command, *[value] * 7)
        pilot.run(0.2)
    pilot.run(2.0)
    assert pilot.heartbeat[1] != (0, 0)
