"""Arguments of a wrong type and implausible targets are refused by name, before anything is sent."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from math import nan

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, InvalidTypeError
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT, PX4, run_scenario
from tests.vehicle.firmware.received_requests import HERE, INT, requests_of

TEXT = [
    ("takeoff altitude", lambda v: v.takeoff("ten")),
    ("takeoff altitude", lambda v: v.takeoff(None)),
    ("latitude", lambda v: v.goto("47", 8.5)),
    ("longitude", lambda v: v.goto(47.0, "8")),
    ("altitude", lambda v: v.goto(*HERE, "30")),
    ("yaw", lambda v: v.goto(*HERE, 30, yaw="north")),
    ("radius", lambda v: v.goto(*HERE, 30, radius="wide")),
    ("north", lambda v: v.move("10")),
    ("up", lambda v: v.move(up=[1])),
    ("radius", lambda v: v.orbit(*HERE, radius="20")),
    ("speed", lambda v: v.orbit(*HERE, speed="fast")),
    ("speed", lambda v: v.set_speed("fast")),
    ("heading", lambda v: v.set_yaw("north")),
    ("latitude", lambda v: v.set_home("47", 8.5)),
    ("timeout", lambda v: v.takeoff(10, timeout="5")),
    ("timeout", lambda v: v.mission.start(timeout="5")),
    ("timeout", lambda v: v.params.get("P_00", timeout="5")),
    ("the value of P_00", lambda v: v.params.set("P_00", "x")),
    ("name", lambda v: v.params.get(3)),
    ("mode", lambda v: v.set_mode(None)),
    (r"items\[0\]", lambda v: v.mission.upload([{"command": 16}])),
]


@pytest.mark.parametrize(("name", "act"), TEXT, ids=[f"{n}-{i}" for i, (n, _) in enumerate(TEXT)])
def test_a_wrong_type_names_the_argument(name, act):
    async def scenario(harness):
        with pytest.raises(InvalidTypeError, match=rf"^{name} must be "):
            await act(harness.vehicle)
        assert requests_of(harness) == []

    run_scenario(scenario)


GUIDED = [
    ("north", lambda g: g.velocity("1")),
    ("yaw", lambda g: g.velocity(1, yaw="north")),
    ("forward", lambda g: g.body_velocity("1")),
    ("up", lambda g: g.position(1, 1, "5")),
    ("altitude", lambda g: g.goto(*HERE, "5")),
    ("thrust", lambda g: g.attitude(0, 0, 0, "full")),
]


def test_setpoints_name_the_argument():
    async def scenario(harness):
        async with harness.vehicle.guided() as guided:
            for name, act in GUIDED:
                with pytest.raises(InvalidTypeError, match=f"^{name} must be a number"):
                    act(guided)

    run_scenario(scenario)


FAR = (-33.9, -151.2)
LIMITS = [
    ("at most 10000 m, got 1e", lambda v, **o: v.takeoff(1e9, wait=False, **o)),
    ("0 to 10000 m above home, got 1e", lambda v, **o: v.goto(*HERE, 1e9, wait=False, **o)),
    ("0 to 10000 m above home, got -5 m", lambda v, **o: v.goto(*HERE, -5, wait=False, **o)),
    ("0 to 10000 m above home, got -5 m", lambda v, **o: v.orbit(*HERE, -5, wait=False, **o)),
    ("0 to 10000 m above home, got -10 m", lambda v, **o: v.move(up=-30, wait=False, **o)),
    (r"within 100 km .*, 19,\d\d\d km away", lambda v, **o: v.goto(*FAR, 30, wait=False, **o)),
    ("within 100 km", lambda v, **o: v.move(north=200_000, wait=False, **o)),
]


@pytest.mark.parametrize(("text", "act"), LIMITS, ids=range(len(LIMITS)))
@pytest.mark.parametrize("autopilot", [PX4, ARDUPILOT], ids=["px4", "ardupilot"])
def test_an_implausible_target_is_sent_only_if_the_limits_are_overridden(autopilot, text, act):
    async def scenario(harness):
        harness.autopilot.arm()
        if "at most" in text:
            harness.autopilot.land()
            await asyncio.sleep(1)
        await harness.vehicle.get_position()
        with pytest.raises(InvalidArgumentError, match=rf"{text}.* override_limits=True"):
            await act(harness.vehicle)
        assert requests_of(harness) == []
        with suppress(TimeoutError):  # ArduPilot's orbit begins with the way to the centre
            await asyncio.wait_for(act(harness.vehicle, override_limits=True), 5)
        assert requests_of(harness) != []

    run_scenario(scenario, autopilot=autopilot)


def test_a_submarine_dives_below_home():
    async def scenario(harness):
        await harness.vehicle.goto(*HERE, -40, wait=False)
        assert requests_of(harness)[-1][-1] == -40

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.SUBMARINE)


def test_a_heading_beyond_the_circle_is_normalised():
    async def scenario(harness):
        harness.autopilot.arm()
        turning = asyncio.create_task(harness.vehicle.set_yaw(500))
        await asyncio.sleep(2)
        assert requests_of(harness)[-1][:3] == (INT, "DO_REPOSITION", "GLOBAL")
        assert not turning.done()
        harness.autopilot.heading = 141.0
        await asyncio.wait_for(turning, 2)
        with pytest.raises(InvalidArgumentError, match="heading must be finite, got nan"):
            await harness.vehicle.set_yaw(nan)

    run_scenario(scenario)


def test_a_turn_is_seen_by_attitude_if_the_position_has_no_heading():
    async def scenario(harness):
        autopilot = harness.autopilot
        harness.autopilot.arm()
        autopilot._position = lambda now: None
        autopilot.publish(
            common.GlobalPositionInt, lambda now: common.GlobalPositionInt(hdg=65535), interval=0.25
        )
        autopilot.publish(common.Attitude, lambda now: common.Attitude(yaw=1.5707963), interval=0.25)
        await asyncio.sleep(1)
        await asyncio.wait_for(harness.vehicle.set_yaw(450), 3)
        assert harness.vehicle.heading == pytest.approx(90, abs=0.1)

    run_scenario(scenario)
