"""A cancelled call leaves no listener, task or operation at either end, and the next call works."""

from __future__ import annotations

import asyncio

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import RemoteError
from tests.vehicle.failures.calls import CALLS
from tests.vehicle.failures.rows import ITEMS, PLACE, Call, call_name
from tests.vehicle.failures.scripted_autopilot import CMD, ScriptedHarness, run_scenario

#: The time in seconds after which both ends have released the resources of a cancelled call.
SETTLE_TIME = 12.0
#: Requests for message rates may follow a cancelled call: a message that was read once stays requested.
RATE_REQUESTS = (common.CommandLong, common.CommandInt)
SETPOINTS = (common.SetPositionTargetLocalNed, common.SetPositionTargetGlobalInt, common.SetAttitudeTarget)
#: Calls that close an object, which cannot be made twice.
CLOSING = {"Telemetry.close", "GuidedSession.__aexit__"}
CANCELLED = [call for call in CALLS if call.name not in CLOSING]


async def begin(harness: ScriptedHarness, call: Call) -> None:
    harness.autopilot.arm(call.armed)
    if call.before:
        await call.before(harness)
    await asyncio.sleep(1.5)


async def cancel_at(harness: ScriptedHarness, call: Call, moment: float) -> bool:
    """Cancel the call at a moment; False if it had ended before."""
    doing = asyncio.create_task(call.do(harness))
    await asyncio.sleep(moment)
    if doing.done():
        assert isinstance(doing.exception(), RemoteError | StopAsyncIteration | None)
        return False
    doing.cancel()
    async with asyncio.timeout(SETTLE_TIME):
        with pytest.raises(asyncio.CancelledError):
            await doing
    return True


def operations_of_vehicle(harness: ScriptedHarness) -> dict[str, object]:
    """Return the operations that are running in the vehicle."""
    autopilot = harness.autopilot
    return {
        "uploads": dict(autopilot.mission._uploads._running),
        "lists": dict(autopilot.parameters._lists),
        "commands": autopilot.commands.server.running,
        "logs": dict(autopilot.logs_server._sessions),
    }


def is_rate_request(message) -> bool:
    return isinstance(message, RATE_REQUESTS) and message.command == CMD.SET_MESSAGE_INTERVAL


async def check_cancelled(harness: ScriptedHarness, call: Call, moment: float) -> None:
    await begin(harness, call)
    await cancel_at(harness, call, moment)  # creates the objects that stay from the first use on
    await asyncio.sleep(SETTLE_TIME)
    harness.autopilot.enter("LOITER")
    await begin(harness, call)
    await asyncio.sleep(SETTLE_TIME)
    before = harness.open_resources()
    await cancel_at(harness, call, moment)
    await asyncio.sleep(SETTLE_TIME)
    assert harness.open_resources() == before
    assert not any(operations_of_vehicle(harness).values())
    harness.autopilot.received.clear()
    await asyncio.sleep(SETTLE_TIME)
    requests = [message for message in harness.autopilot.requests() if not is_rate_request(message)]
    assert requests == []
    harness.autopilot.silent = False
    await harness.vehicle.set_mode("RTL")
    assert harness.vehicle.mode == "RTL"


@pytest.mark.flight_cases(60)
@pytest.mark.fast_cases(29)
@pytest.mark.parametrize("call", CANCELLED, ids=call_name)
@pytest.mark.parametrize("moment", [0.0, 0.55, 3.3])
def test_cancelled(call, moment):
    run_scenario(lambda harness: check_cancelled(harness, call, moment), latency=0.25, **call.options)


@pytest.mark.nightly
@settings(max_examples=60, deadline=None)
@given(st.sampled_from(CANCELLED), st.floats(0.0, 12.0), st.sampled_from([0.0, 0.1, 0.4]))
def test_cancelled_at_any_moment(call, moment, latency):
    run_scenario(lambda harness: check_cancelled(harness, call, moment), latency=latency, **call.options)


@pytest.mark.flight
@settings(max_examples=25, deadline=None)
@given(st.sampled_from(CANCELLED), st.floats(0.0, 12.0))
def test_cancelled_while_nothing_answers(call, moment):
    async def scenario(harness):
        await begin(harness, call)
        harness.autopilot.silent = True
        await cancel_at(harness, call, moment)
        await asyncio.sleep(2 * SETTLE_TIME)
        harness.autopilot.silent = False
        await asyncio.sleep(3)
        await harness.vehicle.set_mode("RTL")

    run_scenario(scenario, latency=0.1, **call.options)


def test_an_upload_is_cancelled_at_the_operations_of_vehicle():
    async def scenario(harness):
        doing = asyncio.create_task(harness.vehicle.mission.upload(ITEMS))
        await asyncio.sleep(1.1)
        assert harness.autopilot.mission._uploads.running(0) is not None
        doing.cancel()
        await asyncio.sleep(0.3)
        assert harness.autopilot.mission._uploads.running(0) is None
        acks = [message for message in harness.autopilot.received if isinstance(message, common.MissionAck)]
        assert acks[-1].type == common.MavMissionResult.OPERATION_CANCELLED

    run_scenario(scenario, latency=0.25)


def test_a_command_under_way_is_cancelled_at_the_operations_of_vehicle():
    async def scenario(harness):
        @harness.autopilot.on_command(CMD.DO_REPOSITION)
        async def reposition(request):
            await asyncio.sleep(1000)

        doing = asyncio.create_task(harness.vehicle.goto(*PLACE))
        await asyncio.sleep(2)
        assert harness.autopilot.commands.server.running
        doing.cancel()
        await asyncio.sleep(0.5)
        assert not harness.autopilot.commands.server.running

    run_scenario(scenario)


@pytest.mark.parametrize("how", ["answering", "without_commands", "silent"])
def test_setpoints_end_with_a_cancelled_block(how):
    """The session first commands the vehicle to hold; without an answer it gives up within some seconds."""

    async def scenario(harness):
        async def steer() -> None:
            async with harness.vehicle.guided() as guided:
                guided.velocity(north=2)
                await asyncio.sleep(1000)

        doing = asyncio.create_task(steer())
        await asyncio.sleep(3)
        assert any(isinstance(message, SETPOINTS) for message in harness.autopilot.received)
        harness.autopilot.silent = how == "silent"
        if how == "without_commands":
            harness.autopilot._host.engine.remove(harness.autopilot.commands.server)
        doing.cancel()
        begun = harness.connection.now()
        with pytest.raises(asyncio.CancelledError):
            await doing
        assert harness.connection.now() - begun < 6
        if how == "answering":
            assert harness.vehicle.mode == "LOITER"
        harness.autopilot.received.clear()
        await asyncio.sleep(5)
        assert not any(isinstance(message, SETPOINTS) for message in harness.autopilot.received)

    run_scenario(scenario)
