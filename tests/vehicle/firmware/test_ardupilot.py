"""Requests to ArduPilot: modes, altitudes above home, and other modes for each vehicle type."""

from __future__ import annotations

import asyncio
from math import degrees

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionRefused, ActionUnsupported, CommandDenied, RemoteError
from mavstack.geodesy import offset_location
from mavstack.services.modes import mode_names
from mavstack.vehicle.firmware.ardupilot import ArduPilot
from tests.vehicle.failures.rows import ITEMS
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT, CMD, RESULT, run_scenario
from tests.vehicle.firmware.received_requests import HERE, INT, LONG, NAN, THERE, mode, requests_of

TYPE = common.MavType
COPTER, PLANE, VTOL = TYPE.QUADROTOR, TYPE.FIXED_WING, TYPE.VTOL_FIXEDROTOR
ROVER, BOAT, SUB = TYPE.GROUND_ROVER, TYPE.SURFACE_BOAT, TYPE.SUBMARINE
GUIDED = {COPTER: 4, PLANE: 15, VTOL: 15, ROVER: 15, BOAT: 15, SUB: 4}
MISSION_START = (LONG, "MISSION_START", 0, 0, 0, 0, 0, 0, 0)


def reposition(*params):
    return (INT, "DO_REPOSITION", "GLOBAL_RELATIVE_ALT", -1, 1, *params)


def takeoff(altitude):
    return (LONG, "NAV_TAKEOFF", 0, 0, 0, 0, 0, 0, altitude)


ASKED = [
    (COPTER, "takeoff", lambda v: v.takeoff(12, wait=False), [mode(4), takeoff(12)]),
    (VTOL, "takeoff", lambda v: v.takeoff(30, wait=False), [mode(15), takeoff(30)]),
    (COPTER, "land", lambda v: v.land(wait=False), [mode(9)]),
    (VTOL, "land", lambda v: v.land(wait=False), [mode(20)]),
    (PLANE, "land", lambda v: v.land(wait=False), [(LONG, "DO_LAND_START", 0, 0, 0, 0, 0, 0, 0)]),
    (COPTER, "rtl", lambda v: v.rtl(wait=False), [mode(6)]),
    (PLANE, "rtl", lambda v: v.rtl(wait=False), [mode(11)]),
    (ROVER, "rtl", lambda v: v.rtl(wait=False), [mode(11)]),
    (COPTER, "hold", lambda v: v.hold(), [mode(17)]),
    (PLANE, "hold", lambda v: v.hold(), [mode(12)]),
    (VTOL, "hold", lambda v: v.hold(), [mode(12)]),
    (ROVER, "hold", lambda v: v.hold(), [mode(4)]),
    (BOAT, "hold", lambda v: v.hold(), [mode(5)]),
    (SUB, "hold", lambda v: v.hold(), [mode(16)]),
    (COPTER, "goto", lambda v: v.goto(*THERE, 30, wait=False), [mode(4), reposition(0, 0, *THERE, 30)]),
    (COPTER, "as high", lambda v: v.goto(*THERE, wait=False), [mode(4), reposition(0, 0, *THERE, 20)]),
    (
        PLANE,
        "goto",
        lambda v: v.goto(*THERE, 80, yaw=90, radius=70, wait=False),
        [mode(15), reposition(70, 0, *THERE, 80)],
    ),
    (
        COPTER,
        "goto and turn",
        lambda v: v.goto(*THERE, 30, yaw=180, wait=False),
        [mode(4), reposition(0, -3.14159, *THERE, 30), (LONG, "CONDITION_YAW", 180, 0, 0, 0, 0, 0, 0)],
    ),
    (PLANE, "orbit", lambda v: v.orbit(*THERE, 80, wait=False), [mode(15), reposition(20, 0, *THERE, 80)]),
    (
        VTOL,
        "orbit the other way round",
        lambda v: v.orbit(*THERE, radius=-90, wait=False),
        [mode(15), reposition(90, 1, *THERE, 20)],
    ),
    (
        COPTER,
        "turn",
        lambda v: v.set_yaw(-90, wait=False),
        [mode(4), (LONG, "CONDITION_YAW", 270, 0, 0, 0, 0, 0, 0)],
    ),
    (COPTER, "mission", lambda v: v.mission.start(), [mode(3), MISSION_START]),
    (ROVER, "mission", lambda v: v.mission.start(), [mode(10), MISSION_START]),
    (PLANE, "mission", lambda v: v.mission.start(), [mode(10)]),
    (COPTER, "pause", lambda v: v.mission.pause(), [mode(17)]),
    (
        COPTER,
        "home there",
        lambda v: v.set_home(*THERE, 500),
        [
            (INT, "DO_SET_HOME", "GLOBAL", 0, 0, 0, NAN, *THERE, 500),
            (LONG, "REQUEST_MESSAGE", 242, 0, 0, 0, 0, 0, 0),
        ],
    ),
]


@pytest.mark.parametrize(
    ("kind", "act", "wanted"),
    [(kind, act, wanted) for kind, _, act, wanted in ASKED],
    ids=[f"{kind.name} {action}" for kind, action, *_ in ASKED],
)
def test_each_vehicle_type(kind, act, wanted):
    async def scenario(harness):
        if wanted[0] in (mode(3), mode(10)):  # AUTO
            await harness.vehicle.mission.upload(ITEMS)
            harness.autopilot.received.clear()
        if wanted[-1][1] == "NAV_TAKEOFF":
            harness.autopilot.land()
            await asyncio.sleep(1)
        await act(harness.vehicle)
        assert requests_of(harness) == wanted
        assert type(harness.vehicle.firmware) is ArduPilot

    run_scenario(scenario, autopilot=ARDUPILOT, kind=kind)


UNSUPPORTED = [
    *((kind, "take off", lambda v: v.takeoff(5)) for kind in (ROVER, BOAT, SUB)),
    *((kind, "land", lambda v: v.land()) for kind in (ROVER, BOAT, SUB)),
    *((kind, "orbit", lambda v: v.orbit(*HERE)) for kind in (ROVER, BOAT, SUB)),
    (PLANE, "turn on the spot", lambda v: v.set_yaw(90)),
    (SUB, "return by itself", lambda v: v.rtl()),
]


@pytest.mark.parametrize(("kind", "what", "act"), UNSUPPORTED)
def test_unsupported_actions_send_nothing(kind, what, act):
    async def scenario(harness):
        with pytest.raises(ActionUnsupported, match=rf"1/1 cannot {what}: it is a"):
            await act(harness.vehicle)
        assert requests_of(harness) == []

    run_scenario(scenario, autopilot=ARDUPILOT, kind=kind)


def test_a_plane_takes_off_by_its_mode():
    async def scenario(harness):
        harness.autopilot.parameters.add("TKOFF_ALT", 50.0)
        harness.autopilot.land()
        await asyncio.sleep(1)
        await harness.vehicle.takeoff(80, wait=False)
        asked = [each for each in requests_of(harness) if each[1] != "REQUEST_MESSAGE"]
        assert asked == [("set", "TKOFF_ALT", 80), mode(13)]

    run_scenario(scenario, autopilot=ARDUPILOT, kind=PLANE)


@pytest.mark.parametrize("kind", GUIDED)
def test_the_mode_in_which_it_waits_has_the_name_that_the_vehicle_shows(kind):
    async def scenario(harness):
        assert harness.vehicle.firmware.waiting_mode in mode_names(ARDUPILOT, kind).values()

    run_scenario(scenario, autopilot=ARDUPILOT, kind=kind)


def test_an_older_version_goes_by_a_setpoint():
    async def scenario(harness):
        harness.autopilot.refuse(CMD.DO_REPOSITION, result=RESULT.UNSUPPORTED)
        await harness.vehicle.goto(*THERE, 30, wait=False)
        await asyncio.sleep(0.1)
        assert requests_of(harness)[-1] == ("setpoint", "GLOBAL_RELATIVE_ALT_INT", *THERE, 30)

    run_scenario(scenario, autopilot=ARDUPILOT)


def test_a_denied_goto_sends_no_setpoint():
    async def scenario(harness):
        harness.autopilot.refuse(CMD.DO_REPOSITION, result=RESULT.DENIED)
        with pytest.raises(CommandDenied):
            await harness.vehicle.goto(*THERE, 30, wait=False)
        assert not [each for each in requests_of(harness) if each[0] == "setpoint"]

    run_scenario(scenario, autopilot=ARDUPILOT)


CIRCLES = [
    (15.0, 4.0, degrees(4 / 15)),
    (-15.0, 4.0, -degrees(4 / 15)),
    (-15.0, None, -20.0),
    (15.0, None, 20.0),
]


@pytest.mark.parametrize(("radius", "speed", "rate"), CIRCLES)
@pytest.mark.parametrize("older", [False, True], ids=["newer", "older"])
def test_a_copter_circles_in_a_mode_of_its_own(radius, speed, rate, older):
    async def scenario(harness):
        parameters = harness.autopilot.parameters
        for name, value in (("CIRCLE_RADIUS", 1000.0), ("CIRCLE_RATE", 20.0)):
            parameters.add(name, value)
        if not older:
            parameters.add("CIRCLE_OPTIONS", 1)
        # It is there already; an older version circles a position that lies ahead of it by the radius.
        harness.autopilot.latitude, harness.autopilot.longitude = offset_location(
            *THERE, 0, -15 if older else 0
        )
        harness.autopilot.heading = 90.0
        harness.autopilot.arm()
        await asyncio.sleep(1)
        await harness.vehicle.orbit(*THERE, 20, radius=radius, speed=speed, wait=False)
        assert parameters["CIRCLE_RADIUS"] == 1500
        assert parameters["CIRCLE_RATE"] == pytest.approx(rate, abs=0.01)
        if not older:
            assert parameters["CIRCLE_OPTIONS"] == 5
        else:
            assert (LONG, "CONDITION_YAW", 90, 0, 0, 0, 0, 0, 0) in requests_of(harness)
        assert requests_of(harness)[-1][1::2][:2] == ("DO_SET_MODE", 7)

    run_scenario(scenario, autopilot=ARDUPILOT)


@pytest.mark.parametrize("cached", [False, True])
def test_the_circle_of_copter_4_7_is_set_in_metres(cached):
    async def scenario(harness):
        parameters = harness.autopilot.parameters
        for name, value in (("CIRCLE_RADIUS_M", 10.0), ("CIRCLE_RATE", 20.0), ("CIRCLE_OPTIONS", 1)):
            parameters.add(name, value)
        harness.autopilot.latitude, harness.autopilot.longitude = THERE
        harness.autopilot.arm()
        await asyncio.sleep(1)
        if cached:
            await harness.vehicle.params.download()
        await harness.vehicle.orbit(*THERE, 20, radius=-15, wait=False)
        assert parameters["CIRCLE_RADIUS_M"] == 15
        assert parameters["CIRCLE_RATE"] == -20
        asked = {each[1] for each in requests_of(harness) if each[0] == "set"}
        assert asked == {"CIRCLE_RADIUS_M", "CIRCLE_RATE", "CIRCLE_OPTIONS"}

    run_scenario(scenario, autopilot=ARDUPILOT)


@pytest.mark.parametrize("name", ["RTL_ALT", "RTL_ALT_M"])
def test_the_error_for_a_renamed_parameter_contains_the_other_name(name):
    async def scenario(harness):
        for call in (harness.vehicle.params.get(name), harness.vehicle.params.set(name, 30)):
            with pytest.raises(RemoteError, match=r"\(RTL_ALT is RTL_ALT_M since ArduPilot 4\.7"):
                await call

    run_scenario(scenario, autopilot=ARDUPILOT)


def test_it_turns_in_guided_as_it_is():
    async def scenario(harness):
        await harness.vehicle.set_mode("GUIDED")
        harness.autopilot.received.clear()
        await harness.vehicle.set_yaw(450, wait=False)
        assert requests_of(harness) == [(LONG, "CONDITION_YAW", 90, 0, 0, 0, 0, 0, 0)]

    run_scenario(scenario, autopilot=ARDUPILOT)


def test_a_plane_without_a_landing_sequence_lands_in_its_own_mode():
    async def scenario(harness):
        harness.autopilot.refuse(CMD.DO_LAND_START, result=RESULT.FAILED)
        await harness.vehicle.land(wait=False)
        assert harness.vehicle.mode == "AUTOLAND"

    run_scenario(scenario, autopilot=ARDUPILOT, kind=PLANE)


def test_the_error_of_a_plane_that_cannot_land_has_advice():
    async def scenario(harness):
        harness.autopilot.refuse(CMD.DO_LAND_START, CMD.DO_SET_MODE, result=RESULT.FAILED)
        with pytest.raises(CommandDenied, match=r"DO_LAND_START .* no landing sequence .* rtl\(\)"):
            await harness.vehicle.land(wait=False)

    run_scenario(scenario, autopilot=ARDUPILOT, kind=PLANE)


def test_a_plane_has_taken_off_a_little_below_the_altitude():
    async def scenario(harness):
        harness.autopilot.parameters.add("TKOFF_ALT", 50.0)
        harness.autopilot.arm()
        harness.autopilot.altitude = 0.0
        harness.autopilot.land()
        await asyncio.sleep(1)
        rising = asyncio.create_task(harness.vehicle.takeoff(60))
        await asyncio.sleep(10)
        assert not rising.done()
        harness.autopilot.landed = common.MavLandedState.IN_AIR
        harness.autopilot.altitude = 56.5
        await asyncio.wait_for(rising, 3)

    run_scenario(scenario, autopilot=ARDUPILOT, kind=PLANE)


@pytest.mark.parametrize("act", [lambda v: v.goto(*THERE, 80), lambda v: v.orbit(*THERE, 80)])
def test_a_plane_on_the_ground_is_not_sent_anywhere(act):
    async def scenario(harness):
        harness.autopilot.arm()
        harness.autopilot.landed = common.MavLandedState.ON_GROUND
        await asyncio.sleep(1.5)
        with pytest.raises(ActionRefused, match="it is on the ground; take off first"):
            await act(harness.vehicle)
        assert requests_of(harness) == []

    run_scenario(scenario, autopilot=ARDUPILOT, kind=PLANE)
