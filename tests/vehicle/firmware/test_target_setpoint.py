"""The target of a vehicle without DO_REPOSITION is sent again until the vehicle has it."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.vehicle.firmware.target_setpoint import ATTEMPTS
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT, CMD, RESULT, run_scenario
from tests.vehicle.firmware.received_requests import THERE, requests_of

TARGET = common.PositionTargetGlobalInt(lat_int=round(THERE[0] * 1e7), lon_int=round(THERE[1] * 1e7), alt=30)
OTHER = common.PositionTargetGlobalInt(lat_int=0, lon_int=0)


def setpoints(harness):
    return [each for each in requests_of(harness) if each[0] == "setpoint"]


def move(harness):
    harness.autopilot.latitude += 0.0001


def report(message):
    return lambda harness: harness.autopilot.send(message)


@pytest.mark.parametrize(
    ("answer", "follows"),
    [(move, True), (report(TARGET), True), (report(OTHER), False), (lambda _: None, False)],
    ids=["moves", "reports the target", "has another target", "does nothing"],
)
def test_a_setpoint_is_sent_until_the_vehicle_follows_it(answer, follows):
    async def scenario(harness):
        harness.autopilot.refuse(CMD.DO_REPOSITION, result=RESULT.UNSUPPORTED)
        arrived = asyncio.Semaphore(0)
        harness.autopilot.add_listener(common.SetPositionTargetGlobalInt, lambda *_: arrived.release())
        going = asyncio.create_task(harness.vehicle.goto(*THERE, 30, wait=False))
        for _ in range(2):
            await arrived.acquire()
        answer(harness)
        await going
        sent = setpoints(harness)
        assert set(sent) == {("setpoint", "GLOBAL_RELATIVE_ALT_INT", *THERE, 30)}
        assert len(sent) in ((2, 3) if follows else (ATTEMPTS,))

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.SUBMARINE)
