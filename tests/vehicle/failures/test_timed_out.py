"""A vehicle that does not answer, or accepts and does nothing, or falls silent, ends a call in time."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import (
    ActionTimeout,
    ContactLost,
    MavstackError,
    RemoteCancelled,
    RemoteError,
    RemoteTimeout,
)
from tests.vehicle.failures.calls import CALLS, enter_guided
from tests.vehicle.failures.rows import Call, named
from tests.vehicle.failures.scripted import CMD, Scene, play

#: No call takes longer if nothing is heard.
BOUND = 150.0
SILENT = [call for call in CALLS if call.silent]
STUCK = [call for call in CALLS if call.stuck]
WATCHED = [call for call in CALLS if call.interrupted]
#: These end well without the vehicle's help, or never by themselves.
ENDLESS = {"MessageStream.__anext__", "Shell.__anext__"}


async def prepare(made: Scene, call: Call) -> None:
    made.script.arm(call.armed)
    if call.before:
        await call.before(made)
    await asyncio.sleep(1.5)


async def failure(made: Scene, call: Call, kind: type[MavstackError]) -> MavstackError:
    """Return the error of the call, within bounded time."""
    begun = asyncio.get_running_loop().time()
    with pytest.raises(kind) as failed:
        await call.do(made)
    assert asyncio.get_running_loop().time() - begun < BOUND
    return failed.value


@pytest.mark.parametrize("call", SILENT, ids=named)
def test_a_vehicle_that_answers_nothing(call):
    async def scenario(made):
        await prepare(made, call)
        made.script.silent = True
        error = await failure(made, call, RemoteTimeout)
        assert type(error) is call.silent
        assert isinstance(error, TimeoutError)
        assert "1/1 failed" in str(error)
        if call.silent is not ActionTimeout:
            assert call.asked.partition(" ")[0] in str(error) or error.operation in str(error)

    play(scenario, **call.options)


@pytest.mark.parametrize("call", STUCK, ids=named)
def test_a_vehicle_that_accepts_and_does_nothing(call):
    async def scenario(made):
        await prepare(made, call)
        made.script.acts = call.interrupted and call.stuck[0] is ActionTimeout
        asyncio.get_running_loop().call_later(3.0, made.script.send_statustext, "motor 2 is weak", 3)
        error = await failure(made, call, RemoteTimeout)
        kind, text = call.stuck
        assert type(error) is kind
        assert text in str(error)
        if kind is ActionTimeout and call.name != "Vehicle.reboot":
            assert error.status_texts == ("motor 2 is weak",)
            assert str(error).endswith("(motor 2 is weak)")

    play(scenario, **call.options)


@pytest.mark.parametrize("call", WATCHED, ids=named)
def test_a_timeout_of_the_program(call):
    limited = {
        "Vehicle.takeoff": lambda s: s.vehicle.takeoff(30, timeout=5),
        "Vehicle.land": lambda s: s.vehicle.land(timeout=5),
        "Vehicle.rtl": lambda s: s.vehicle.rtl(timeout=5),
        "Vehicle.goto": lambda s: s.vehicle.goto(47.5, 8.5, 20, timeout=5),
        "Vehicle.move": lambda s: s.vehicle.move(east=500, timeout=5),
        "Vehicle.orbit": lambda s: s.vehicle.orbit(47.5, 8.5, timeout=5),
        "Vehicle.set_yaw": lambda s: s.vehicle.set_yaw(90, timeout=5),
        "Mission.fly": lambda s: s.vehicle.mission.fly(timeout=5),
    }[call.name]

    async def scenario(made):
        await prepare(made, call)
        begun = made.node.now()
        with pytest.raises(ActionTimeout, match=r"not done in 5 s, [0-9]+ (m|degrees|items) to go"):
            await limited(made)
        assert 5 <= made.node.now() - begun < 8

    play(scenario)


@pytest.mark.parametrize("call", WATCHED, ids=named)
def test_silence_in_the_middle(call):
    async def scenario(made):
        await prepare(made, call)

        def fall_silent() -> None:
            made.script.send_statustext("battery critical", 2)
            made.script.silent = True

        asyncio.get_running_loop().call_later(4.0, fall_silent)
        begun = made.node.now()
        error = await failure(made, call, ContactLost)
        assert made.node.now() - begun < 12
        assert "1/1 failed: it fell silent (battery critical)" in str(error)
        made.script.silent = False
        await asyncio.sleep(2)
        assert made.vehicle.alive
        await made.vehicle.set_mode("LOITER")  # the same object goes on

    play(scenario, **call.options)


@pytest.mark.fast_cases(40)
@pytest.mark.parametrize("call", [call for call in CALLS if call.name not in ENDLESS], ids=named)
@pytest.mark.parametrize("moment", [0.3, 1.1])
def test_silence_at_any_moment_ends_every_call(call, moment):
    """Assert that running calls succeed or raise a typed error, and do not wait for ever."""

    async def scenario(made):
        await prepare(made, call)
        asyncio.get_running_loop().call_later(moment, lambda: setattr(made.script, "silent", True))
        async with asyncio.timeout(BOUND):
            outcome = (await asyncio.gather(call.do(made), return_exceptions=True))[0]
        if isinstance(outcome, Exception):
            assert isinstance(outcome, RemoteError)
            assert "1/1" in str(outcome)

    play(scenario, latency=0.25, **call.options)


@pytest.mark.fast_cases(84)
@pytest.mark.parametrize("call", CALLS, ids=named)
@pytest.mark.parametrize("moment", [0.0, 0.7])
def test_closing_the_connection_in_the_middle(call, moment):
    async def scenario(made):
        await prepare(made, call)
        doing = asyncio.create_task(call.do(made))
        await asyncio.sleep(moment)
        if doing.done():
            return
        await made.node.close()
        async with asyncio.timeout(10):
            outcome = (await asyncio.gather(doing, return_exceptions=True))[0]
        ended_well = outcome is None or isinstance(outcome, StopAsyncIteration | bool)
        kind = RemoteError if moment else MavstackError  # it had perhaps not begun
        assert ended_well or isinstance(outcome, kind), repr(outcome)
        if call.interrupted and moment:
            assert type(outcome) is RemoteCancelled
            assert "1/1 failed" in str(outcome)

    play(scenario, latency=0.25, **call.options)


@pytest.mark.fast_cases(55)
@pytest.mark.parametrize("call", [call for call in CALLS if call.name not in ENDLESS], ids=named)
def test_the_peer_closes_its_link_in_the_middle(call):
    async def scenario(made):
        await prepare(made, call)
        doing = asyncio.create_task(call.do(made))
        await asyncio.sleep(0.7)
        if doing.done():
            return
        await made.script.close()
        async with asyncio.timeout(BOUND):
            outcome = (await asyncio.gather(doing, return_exceptions=True))[0]
        assert outcome is None or isinstance(outcome, RemoteError | bool), repr(outcome)
        if call.interrupted:
            assert isinstance(outcome, RemoteTimeout)

    play(scenario, latency=0.25, **call.options)


@pytest.mark.parametrize(
    "call", [call for call in SILENT if call.name != "GuidedSession.__aexit__"], ids=named
)
def test_a_closed_connection_raises_immediately(call):
    async def scenario(made):
        await prepare(made, call)
        await made.node.close()
        begun = asyncio.get_running_loop().time()
        with pytest.raises(MavstackError, match=r"is not open|was closed"):
            await call.do(made)
        assert asyncio.get_running_loop().time() - begun < 1

    play(scenario, **call.options)


def test_a_guided_session_with_a_vehicle_that_falls_silent():
    async def scenario(made):
        await enter_guided(made)
        made.script.silent = True
        await asyncio.sleep(8)
        with pytest.raises(ContactLost, match="following setpoints with 1/1 failed: it fell silent"):
            made.guided.velocity(1)
        with pytest.raises(RemoteTimeout):
            await made.guided.__aexit__(None, None, None)

    play(scenario)


def test_a_guided_session_on_a_closed_connection():
    async def scenario(made):
        await enter_guided(made)
        await made.node.close()
        with pytest.raises(RemoteCancelled, match=r"following setpoints .*: the connection was closed"):
            made.guided.velocity(1)
        await made.guided.__aexit__(None, None, None)

    play(scenario)


def test_a_reboot_without_acknowledgement_is_not_repeated():
    """It would reboot a second time when it is back."""

    async def scenario(made):
        asked = []

        def reboot(request):
            asked.append(request)
            made.script.silent = True
            asyncio.get_running_loop().call_later(12.0, lambda: setattr(made.script, "silent", False))
            return common.MavResult.ACCEPTED

        made.script.commands.server.support(CMD.PREFLIGHT_REBOOT_SHUTDOWN, reboot)
        await made.vehicle.reboot()
        assert made.vehicle.alive
        while_away = len(asked)
        await asyncio.sleep(30)
        assert len(asked) == while_away

    play(scenario)


def test_a_reboot_without_waiting():
    async def scenario(made):
        await made.vehicle.reboot(wait=False)
        made.script.silent = True
        with pytest.raises(ContactLost, match="rebooting 1/1 failed: it fell silent without an ack"):
            await made.vehicle.reboot(wait=False)

    play(scenario)
