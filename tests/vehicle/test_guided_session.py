"""Guided sessions: the stream of setpoints, the mode, and the end of the block."""

from __future__ import annotations

import asyncio
from itertools import pairwise
from math import pi

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, ModeTimeout, SetpointError
from mavstack.rotation import from_euler
from mavstack.services.setpoints import GlobalSetpoint, LocalSetpoint
from mavstack.vehicle.guided_session import STREAM_LEAD_TIME
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT, CMD, PX4, run_scenario

LOCAL, GLOBAL = common.SetPositionTargetLocalNed, common.SetPositionTargetGlobalInt
ATTITUDE = common.SetAttitudeTarget
BOTH = pytest.mark.parametrize("autopilot", [PX4, ARDUPILOT], ids=["px4", "ardupilot"])
MODES = {PX4: ("OFFBOARD", "LOITER"), ARDUPILOT: ("GUIDED", "BRAKE")}


def setpoints(harness):
    return [
        message for message in harness.autopilot.received if isinstance(message, (LOCAL, GLOBAL, ATTITUDE))
    ]


def timed(harness):
    """Return a list that grows by the time and the name of each received setpoint and mode command."""
    times = []

    def note(packet):
        name = type(packet.message).__name__
        if name != "CommandLong" or packet.message.command == CMD.DO_SET_MODE:
            times.append((harness.connection.now(), name))

    harness.autopilot.add_packet_listener((LOCAL, GLOBAL, ATTITUDE, common.CommandLong), note)
    return times


@BOTH
def test_the_stream_begins_before_the_mode_and_keeps_its_rate(autopilot):
    async def scenario(harness):
        times = timed(harness)
        entered, held = MODES[autopilot]
        async with harness.vehicle.guided(rate=20) as guided:
            assert harness.vehicle.mode == entered
            guided.velocity(north=2.0, east=1.0, up=0.5, yaw=90)
            await asyncio.sleep(4)
        assert harness.vehicle.mode == held
        mode_asked = next(time for time, name in times if name == "CommandLong")
        sent = [time for time, name in times if name != "CommandLong"]
        assert mode_asked - sent[0] >= STREAM_LEAD_TIME * 0.9
        gaps = [later - earlier for earlier, later in pairwise(sent)]
        assert max(gaps) < 0.075
        assert len(sent) / (sent[-1] - sent[0]) == pytest.approx(20, rel=0.1)
        newest = [each for each in setpoints(harness) if each.vx == 2.0]
        assert (newest[0].vy, newest[0].vz) == (1.0, -0.5)
        assert newest[0].yaw == pytest.approx(pi / 2, abs=1e-5)
        standing = setpoints(harness)
        # The stream begins before the first setpoint of the program, and ends while the vehicle holds.
        assert (standing[0].vx, standing[-1].vx) == (0.0, 0.0)

    # The answer to the hold takes longer than the time between two setpoints.
    run_scenario(scenario, autopilot=autopilot, latency=0.04)


@BOTH
def test_the_stream_ends_with_the_block(autopilot):
    async def scenario(harness):
        await harness.vehicle.set_mode("RTL")  # creates the objects that stay from the first use on
        before = harness.open_resources()
        async with harness.vehicle.guided():
            await asyncio.sleep(1)
        harness.autopilot.received.clear()
        await asyncio.sleep(5)
        assert setpoints(harness) == []
        assert harness.open_resources() == before

    run_scenario(scenario, autopilot=autopilot)


async def fail_without_holding(harness):
    async with harness.vehicle.guided():
        harness.autopilot.refuse(CMD.DO_SET_MODE)
        raise ZeroDivisionError


async def refuse_to_hold(harness):
    async with harness.vehicle.guided():
        harness.autopilot.refuse(CMD.DO_SET_MODE)
        harness.autopilot.on_refusal = lambda: harness.send_statustext("no position")


def test_an_error_in_the_block_is_raised():
    async def scenario(harness):
        with pytest.raises(ZeroDivisionError):
            async with harness.vehicle.guided():
                raise ZeroDivisionError
        assert harness.vehicle.mode == "LOITER"  # the vehicle holds nevertheless
        with pytest.raises(ZeroDivisionError):  # also if the vehicle refuses to hold
            await fail_without_holding(harness)
        harness.autopilot.received.clear()
        await asyncio.sleep(3)
        assert setpoints(harness) == []

    run_scenario(scenario)


def test_a_refused_hold_is_raised():
    async def scenario(harness):
        with pytest.raises(CommandDenied, match=r"DO_SET_MODE on 1/1 failed: DENIED \(no position\)"):
            await refuse_to_hold(harness)
        harness.autopilot.received.clear()
        await asyncio.sleep(3)
        assert setpoints(harness) == []

    run_scenario(scenario)


@pytest.mark.parametrize("acts", [True, False], ids=["denied", "ignored"])
def test_a_mode_that_is_not_entered_ends_the_stream(acts):
    async def scenario(harness):
        await harness.vehicle.set_mode("RTL")
        before = harness.open_resources()
        harness.autopilot.executes = acts
        if acts:
            harness.autopilot.refuse(CMD.DO_SET_MODE)
        with pytest.raises(CommandDenied if acts else ModeTimeout):
            async with harness.vehicle.guided():
                pytest.fail("it was not to be entered")
        harness.autopilot.received.clear()
        await asyncio.sleep(3)
        assert setpoints(harness) == []
        assert harness.open_resources() == before

    run_scenario(scenario)


def test_a_session_that_was_not_entered_leaves_nothing():
    async def scenario(harness):
        before = harness.open_resources()
        for _ in range(5):
            harness.vehicle.guided()
        await asyncio.sleep(1)
        assert harness.open_resources() == before

    run_scenario(scenario)


def test_each_kind_of_setpoint():
    async def scenario(harness):
        async with harness.vehicle.guided() as guided:
            guided.body_velocity(forward=3, right=1, up=1, yaw_rate=90)
            await asyncio.sleep(0.2)
            body = setpoints(harness)[-1]
            assert body.coordinate_frame == common.MavFrame.BODY_NED
            assert (body.vx, body.vy, body.vz) == (3, 1, -1)
            assert body.yaw_rate == pytest.approx(pi / 2, abs=1e-5)
            guided.position(10, -5, 20, yaw=180)
            await asyncio.sleep(0.2)
            place = setpoints(harness)[-1]
            assert (place.x, place.y, place.z) == (10, -5, -20)
            assert abs(place.yaw) == pytest.approx(pi, abs=1e-5)
            guided.goto(47.5, 8.25, 30)
            await asyncio.sleep(0.2)
            far = setpoints(harness)[-1]
            assert (far.lat_int, far.lon_int, far.alt) == (475000000, 82500000, 518)  # home is at 488 m
            guided.attitude(roll=0, pitch=0, yaw=90, thrust=0.5)
            await asyncio.sleep(0.2)
            attitude = setpoints(harness)[-1]
            assert attitude.q == pytest.approx((0.70711, 0, 0, 0.70711), abs=1e-4)
            assert attitude.thrust == 0.5
            with pytest.raises(SetpointError):
                guided.set(LocalSetpoint())
            await asyncio.sleep(0.2)
            assert setpoints(harness)[-1].thrust == 0.5  # refused setpoints change nothing

    run_scenario(scenario)


@pytest.mark.parametrize(
    ("autopilot", "frame", "altitude"),
    [(PX4, common.MavFrame.GLOBAL_INT, 518), (ARDUPILOT, common.MavFrame.GLOBAL_RELATIVE_ALT_INT, 30)],
    ids=["px4", "ardupilot"],
)
def test_px4_gets_altitudes_above_the_sea(autopilot, frame, altitude):
    """It converts heights above home wrongly; home is 488 m above the sea."""

    async def scenario(harness):
        async with harness.vehicle.guided() as guided:
            guided.goto(47.5, 8.25, 30)
            await asyncio.sleep(0.2)
            far = setpoints(harness)[-1]
            assert (far.coordinate_frame, far.alt) == (frame, altitude)
        async with harness.vehicle.guided(first=GlobalSetpoint(47.5, 8.25, 30)):
            first = setpoints(harness)[-1]
            assert (first.coordinate_frame, first.alt) == (frame, altitude)

    run_scenario(scenario, autopilot=autopilot)


def test_it_begins_with_the_setpoint_that_it_was_given():
    async def scenario(harness):
        first = LocalSetpoint(velocity=(0.0, 0.0, -1.5))
        async with harness.vehicle.guided(rate=10, first=first):
            assert {message.vz for message in setpoints(harness)} == {-1.5}

    run_scenario(scenario)


@pytest.mark.parametrize(
    ("angles", "wanted"),
    [
        ((0, 0, 0), (1, 0, 0, 0)),
        ((pi, 0, 0), (0, 1, 0, 0)),
        ((0, pi / 2, 0), (0.70711, 0, 0.70711, 0)),
        ((0.1, 0.2, 0.3), (0.98335, 0.03427, 0.10602, 0.14357)),
    ],
)
def test_rotations(angles, wanted):
    assert from_euler(*angles) == pytest.approx(wanted, abs=1e-4)
