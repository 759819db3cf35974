"""A cancelled call leaves nothing behind, on neither end, and the vehicle can be asked again."""

from __future__ import annotations

import asyncio

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import RemoteError
from tests.vehicle.failures.calls import CALLS
from tests.vehicle.failures.rows import ITEMS, PLACE, Call, named
from tests.vehicle.failures.scripted import CMD, Scene, play

#: Long enough for what was cancelled to be let go of on both ends.
SETTLE = 12.0
#: A rate that was asked for without saying which stays; who reads a message once wants its latest value too.
KEPT = (common.CommandLong, common.CommandInt)
#: Commands to leave a mode.
LETTING_GO = (common.CommandCancel, common.SerialControl, common.LogRequestEnd)
SETPOINTS = (common.SetPositionTargetLocalNed, common.SetPositionTargetGlobalInt, common.SetAttitudeTarget)
#: Closing is for good, so it is not done twice.
FOR_GOOD = {"Telemetry.close", "GuidedSession.__aexit__"}
CANCELLED = [call for call in CALLS if call.name not in FOR_GOOD]


async def begin(made: Scene, call: Call) -> None:
    made.script.arm(call.armed)
    if call.before:
        await call.before(made)
    await asyncio.sleep(1.5)


async def cancel_at(made: Scene, call: Call, moment: float) -> bool:
    """Cancel the call at a moment; False if it had ended before."""
    doing = asyncio.create_task(call.do(made))
    await asyncio.sleep(moment)
    if doing.done():
        assert isinstance(doing.exception(), RemoteError | StopAsyncIteration | None)
        return False
    doing.cancel()
    async with asyncio.timeout(SETTLE):
        with pytest.raises(asyncio.CancelledError):
            await doing
    return True


def other_end(made: Scene) -> dict[str, object]:
    """Return the operations that are running at the other end."""
    script = made.script
    return {
        "uploads": dict(script.mission._uploads._running),
        "lists": dict(script.parameters._lists),
        "commands": script.commands.server.running,
        "logs": dict(script.logs_server._sessions),
    }


def is_kept(message) -> bool:
    return isinstance(message, KEPT) and message.command == CMD.SET_MESSAGE_INTERVAL


async def check_cancelled(made: Scene, call: Call, moment: float) -> None:
    await begin(made, call)
    await cancel_at(made, call, moment)  # what is made when it is first used is there now
    await asyncio.sleep(SETTLE)
    made.script.enter("LOITER")
    await begin(made, call)
    await asyncio.sleep(SETTLE)
    before = made.registers()
    await cancel_at(made, call, moment)
    await asyncio.sleep(SETTLE)
    assert made.registers() == before
    assert not any(other_end(made).values())
    made.script.heard.clear()
    await asyncio.sleep(SETTLE)
    still = [message for message in made.script.asked() if not is_kept(message)]
    assert still == []
    made.script.silent = False
    await made.vehicle.set_mode("RTL")
    assert made.vehicle.mode == "RTL"


@pytest.mark.fast_cases(29)
@pytest.mark.parametrize("call", CANCELLED, ids=named)
@pytest.mark.parametrize("moment", [0.0, 0.55, 3.3])
def test_cancelled(call, moment):
    play(lambda made: check_cancelled(made, call, moment), latency=0.25, **call.options)


@pytest.mark.nightly
@settings(max_examples=60, deadline=None)
@given(st.sampled_from(CANCELLED), st.floats(0.0, 12.0), st.sampled_from([0.0, 0.1, 0.4]))
def test_cancelled_at_any_moment(call, moment, latency):
    play(lambda made: check_cancelled(made, call, moment), latency=latency, **call.options)


@pytest.mark.flight
@settings(max_examples=25, deadline=None)
@given(st.sampled_from(CANCELLED), st.floats(0.0, 12.0))
def test_cancelled_while_nothing_answers(call, moment):
    async def scenario(made):
        await begin(made, call)
        made.script.silent = True
        await cancel_at(made, call, moment)
        await asyncio.sleep(2 * SETTLE)
        made.script.silent = False
        await asyncio.sleep(3)
        await made.vehicle.set_mode("RTL")

    play(scenario, latency=0.1, **call.options)


def test_an_upload_is_cancelled_at_the_other_end():
    async def scenario(made):
        doing = asyncio.create_task(made.vehicle.mission.upload(ITEMS))
        await asyncio.sleep(1.1)
        assert made.script.mission._uploads.running(0) is not None
        doing.cancel()
        await asyncio.sleep(0.3)
        assert made.script.mission._uploads.running(0) is None
        acks = [message for message in made.script.heard if isinstance(message, common.MissionAck)]
        assert acks[-1].type == common.MavMissionResult.OPERATION_CANCELLED

    play(scenario, latency=0.25)


def test_a_command_under_way_is_cancelled_at_the_other_end():
    async def scenario(made):
        @made.script.on_command(CMD.DO_REPOSITION)
        async def reposition(request):
            await asyncio.sleep(1000)

        doing = asyncio.create_task(made.vehicle.goto(*PLACE))
        await asyncio.sleep(2)
        assert made.script.commands.server.running
        doing.cancel()
        await asyncio.sleep(0.5)
        assert not made.script.commands.server.running

    play(scenario)


@pytest.mark.parametrize("how", ["answering", "deaf", "silent"])
def test_setpoints_end_with_a_cancelled_block(how):
    """It holds first; a vehicle that does not answer is not argued with for long."""

    async def scenario(made):
        async def steer() -> None:
            async with made.vehicle.guided() as guided:
                guided.velocity(north=2)
                await asyncio.sleep(1000)

        doing = asyncio.create_task(steer())
        await asyncio.sleep(3)
        assert any(isinstance(message, SETPOINTS) for message in made.script.heard)
        made.script.silent = how == "silent"
        if how == "deaf":
            made.script._host.engine.remove(made.script.commands.server)
        doing.cancel()
        begun = made.node.now()
        with pytest.raises(asyncio.CancelledError):
            await doing
        assert made.node.now() - begun < 6
        if how == "answering":
            assert made.vehicle.mode == "LOITER"
        made.script.heard.clear()
        await asyncio.sleep(5)
        assert not any(isinstance(message, SETPOINTS) for message in made.script.heard)

    play(scenario)
