"""Requests to PX4: commands with altitudes above mean sea level, and modes by main and sub mode."""

from __future__ import annotations

import asyncio
from math import pi
from types import SimpleNamespace

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionUnsupported
from mavstack.services.setpoints import GlobalSetpoint, LocalSetpoint
from mavstack.vehicle.firmware.px4 import Px4
from mavstack.vehicle.telemetry.values import Position
from tests.vehicle.failures.scripted_autopilot import run_scenario
from tests.vehicle.firmware.received_requests import HERE, INT, LONG, NAN, THERE, mode, requests_of

TYPE = common.MavType
COPTER, PLANE, ROVER, BOAT, SUB = (
    *(TYPE.QUADROTOR, TYPE.FIXED_WING, TYPE.GROUND_ROVER, TYPE.SURFACE_BOAT),
    TYPE.SUBMARINE,
)
HOME_ALTITUDE = 488.0
ASK_HOME = (LONG, "REQUEST_MESSAGE", 242, 0, 0, 0, 0, 0, 0)


def reposition(*params):
    return (INT, "DO_REPOSITION", "GLOBAL", *params)


ASKED = {
    "arm": (lambda v: v.arm(), [(LONG, "COMPONENT_ARM_DISARM", 1, 0, 0, 0, 0, 0, 0)]),
    "arm by force": (lambda v: v.arm(force=True), [(LONG, "COMPONENT_ARM_DISARM", 1, 21196, 0, 0, 0, 0, 0)]),
    "takeoff": (
        lambda v: v.takeoff(12, wait=False),
        [ASK_HOME, (LONG, "NAV_TAKEOFF", NAN, 0, 0, NAN, NAN, NAN, HOME_ALTITUDE + 12)],
    ),
    "land": (lambda v: v.land(wait=False), [(LONG, "NAV_LAND", 0, 0, 0, NAN, NAN, NAN, NAN)]),
    "rtl": (lambda v: v.rtl(wait=False), [(LONG, "NAV_RETURN_TO_LAUNCH", 0, 0, 0, 0, 0, 0, 0)]),
    "hold": (lambda v: v.hold(), [mode(4, 3)]),
    "goto": (
        lambda v: v.goto(*THERE, 30, wait=False),
        [ASK_HOME, reposition(-1, 1, 0, NAN, *THERE, HOME_ALTITUDE + 30)],
    ),
    "goto at its altitude": (
        lambda v: v.goto(*THERE, yaw=90, wait=False),
        [reposition(-1, 1, 0, round(pi / 2, 5), *THERE, NAN)],
    ),
    "goto around": (
        lambda v: v.goto(*THERE, radius=60, yaw=270, wait=False),
        [reposition(-1, 1, 60, round(-pi / 2, 5), *THERE, NAN)],
    ),
    "orbit": (
        lambda v: v.orbit(*THERE, 40, radius=-25, speed=3, wait=False),
        [ASK_HOME, (INT, "DO_ORBIT", "GLOBAL", -25, 3, 0, NAN, *THERE, HOME_ALTITUDE + 40)],
    ),
    "orbit as it likes": (
        lambda v: v.orbit(*THERE, wait=False),
        [(INT, "DO_ORBIT", "GLOBAL", 20, NAN, 0, NAN, *THERE, NAN)],
    ),
    "speed": (lambda v: v.set_speed(7), [(LONG, "DO_CHANGE_SPEED", 1, 7, -1, 0, 0, 0, 0)]),
    "home here": (lambda v: v.set_home(), [(LONG, "DO_SET_HOME", 1, 0, 0, 0, 0, 0, 0), ASK_HOME]),
    "home there": (
        lambda v: v.set_home(*THERE, 500),
        [(INT, "DO_SET_HOME", "GLOBAL", 0, 0, 0, NAN, *THERE, 500), ASK_HOME],
    ),
    "home there, as high": (
        lambda v: v.set_home(*THERE),
        [ASK_HOME, (INT, "DO_SET_HOME", "GLOBAL", 0, 0, 0, NAN, *THERE, HOME_ALTITUDE), ASK_HOME],
    ),
    "mission": (lambda v: v.mission.start(), [mode(4, 4)]),
    "pause": (lambda v: v.mission.pause(), [mode(4, 3)]),
    "reboot": (lambda v: v.reboot(wait=False), [(LONG, "PREFLIGHT_REBOOT_SHUTDOWN", 1, 0, 0, 0, 0, 0, 0)]),
}


@pytest.mark.parametrize("action", ASKED)
def test_a_copter(action):
    act, wanted = ASKED[action]

    async def scenario(harness):
        harness.autopilot.altitude = 10.0
        await act(harness.vehicle)
        assert requests_of(harness) == wanted
        assert type(harness.vehicle.firmware) is Px4

    run_scenario(scenario)


def test_turning_leaves_it_where_it_is():
    async def scenario(harness):
        await harness.vehicle.set_yaw(45, wait=False)
        (asked,) = requests_of(harness)
        assert asked[:6] == ("int", "DO_REPOSITION", "GLOBAL", -1, 1, 0)
        assert asked[6] == pytest.approx(pi / 4, abs=1e-4)
        raw = next(
            message for message in harness.autopilot.received if isinstance(message, common.CommandInt)
        )
        assert (raw.x, raw.y) == (0x7FFFFFFF, 0x7FFFFFFF)  # INT32_MAX stands for no position

    run_scenario(scenario)


@pytest.mark.parametrize("kind", [ROVER, BOAT, SUB])
def test_rovers_and_submarines(kind):
    async def scenario(harness):
        vehicle = harness.vehicle
        for action in (vehicle.takeoff(10), vehicle.land(), vehicle.orbit(*HERE)):
            with pytest.raises(ActionUnsupported, match=r"1/1 cannot (take off|land|orbit): it is a"):
                await action
        assert requests_of(harness) == []
        await vehicle.goto(*THERE, wait=False)
        assert requests_of(harness) == [reposition(-1, 1, 0, NAN, *THERE, NAN)]

    run_scenario(scenario, kind=kind)


def test_a_plane_does_not_turn_on_the_spot():
    async def scenario(harness):
        with pytest.raises(ActionUnsupported, match="cannot turn on the spot: it is a plane"):
            await harness.vehicle.set_yaw(90)
        assert requests_of(harness) == []

    run_scenario(scenario, kind=PLANE)


def test_without_home_its_altitude_follows_from_the_position():
    async def scenario(harness):
        harness.autopilot.reports_home = False
        await harness.vehicle.takeoff(12, wait=False)
        assert requests_of(harness)[-1][-1] == pytest.approx(HOME_ALTITUDE + 12, abs=0.01)

    run_scenario(scenario)


def test_it_returns_though_home_is_not_known():
    async def scenario(harness):
        harness.autopilot.reports_home = False
        harness.autopilot.arm()
        asyncio.get_running_loop().call_later(100, harness.autopilot.arm, False)
        begun = harness.connection.now()
        await harness.vehicle.rtl()
        assert harness.connection.now() - begun == pytest.approx(100, abs=30)
        assert requests_of(harness)[0][:2] == (LONG, "NAV_RETURN_TO_LAUNCH")

    run_scenario(scenario)


@pytest.mark.parametrize(
    ("place", "altitude", "expected"),
    [
        (Position(47.0, 8.0, 510.0, 22.0), 30.0, (518.0, common.MavFrame.GLOBAL)),
        (Position(47.0, 8.0, 510.0, 10.0), 30.0, (530.0, common.MavFrame.GLOBAL)),  # home has moved
        (Position(47.0, 8.0, 510.0), 30.0, (30.0, common.MavFrame.GLOBAL_RELATIVE_ALT)),
        (Position(47.0, 8.0, None, 22.0), 30.0, (30.0, common.MavFrame.GLOBAL_RELATIVE_ALT)),
        (None, 30.0, (30.0, common.MavFrame.GLOBAL_RELATIVE_ALT)),
        (Position(47.0, 8.0, 510.0, 22.0), None, (None, common.MavFrame.GLOBAL_RELATIVE_ALT)),
    ],
)
def test_setpoints_are_above_the_sea_if_the_height_of_home_is_known(place, altitude, expected):
    firmware = Px4(SimpleNamespace(position=place))
    found = firmware.adapt_setpoint(GlobalSetpoint(47.5, 8.5, altitude))
    assert (found.altitude, found.frame) == expected


def test_other_setpoints_stay_as_they_are():
    firmware = Px4(SimpleNamespace(position=Position(47.0, 8.0, 510.0, 22.0)))
    above_ground = GlobalSetpoint(47.5, 8.5, 30.0, frame=common.MavFrame.GLOBAL_TERRAIN_ALT)
    for setpoint in (above_ground, LocalSetpoint(position=(1.0, 2.0, -3.0))):
        assert firmware.adapt_setpoint(setpoint) is setpoint
