"""An unknown firmware receives the standard commands and modes."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionUnsupported
from mavstack.vehicle.firmware import Firmware, firmware_of
from tests.vehicle.failures.scripted_autopilot import RESULT, run_scenario
from tests.vehicle.firmware.received_requests import INT, LONG, NAN, THERE, requests_of

GENERIC = common.MavAutopilot.GENERIC
STANDARD = common.MavStandardMode


@pytest.mark.parametrize(
    ("act", "wanted"),
    [
        (lambda v: v.hold(), STANDARD.POSITION_HOLD),
        (lambda v: v.mission.start(), STANDARD.MISSION),
        (lambda v: v.mission.pause(), STANDARD.POSITION_HOLD),
    ],
)
def test_standard_modes(act, wanted):
    async def scenario(harness):
        modes = []

        def standard(request):
            modes.append(request.command.param1)
            message = common.CurrentMode(standard_mode=int(request.command.param1), custom_mode=1)
            asyncio.get_running_loop().call_soon(harness.autopilot.send, message)
            return RESULT.ACCEPTED

        harness.autopilot.commands.server.support(common.MavCmd.DO_SET_STANDARD_MODE, standard)
        await act(harness.vehicle)
        assert modes == [wanted]

    run_scenario(scenario, autopilot=GENERIC)


def test_standard_commands():
    async def scenario(harness):
        vehicle = harness.vehicle
        await vehicle.takeoff(10, wait=False)
        await vehicle.land(wait=False)
        await vehicle.rtl(wait=False)
        await vehicle.goto(*THERE, 20, wait=False)
        await vehicle.set_yaw(90, wait=False)
        assert [each for each in requests_of(harness) if each[1] != "REQUEST_MESSAGE"] == [
            (LONG, "NAV_TAKEOFF", NAN, 0, 0, NAN, NAN, NAN, 498),
            (LONG, "NAV_LAND", 0, 0, 0, NAN, NAN, NAN, NAN),
            (LONG, "NAV_RETURN_TO_LAUNCH", 0, 0, 0, 0, 0, 0, 0),
            (INT, "DO_REPOSITION", "GLOBAL", -1, 1, 0, NAN, *THERE, 508),
            (LONG, "CONDITION_YAW", 90, 0, 0, 0, 0, 0, 0),
        ]
        assert type(firmware_of(vehicle)) is Firmware
        assert vehicle.firmware.modes_of("goto") is None

    run_scenario(scenario, autopilot=GENERIC)


def test_it_does_not_follow_setpoints():
    async def scenario(harness):
        before = harness.open_resources()
        with pytest.raises(ActionUnsupported, match="cannot follow setpoints"):
            async with harness.vehicle.guided():
                pytest.fail("the block must not be entered")
        assert harness.open_resources() == before

    run_scenario(scenario, autopilot=GENERIC)


@pytest.mark.parametrize(
    ("heading", "radians"), [(0, 0), (90, 1.570796), (180, -3.141593), (270, -1.570796), (359, -0.017453)]
)
def test_headings_as_angles(heading, radians):
    async def scenario(harness):
        assert harness.vehicle.firmware.yaw_of(heading) == pytest.approx(radians, abs=1e-5)

    run_scenario(scenario, autopilot=GENERIC)
