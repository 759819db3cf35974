"""A call ends in bounded time if the vehicle does not answer, accepts and does nothing, or becomes silent."""

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
from tests.vehicle.failures.rows import Call, call_name
from tests.vehicle.failures.scripted_autopilot import CMD, ScriptedHarness, run_scenario

#: The longest time in seconds that a call takes if the vehicle accepts and does nothing.
MAX_DURATION = 150.0
#: The longest time in seconds that a call takes if the vehicle is silent, but for the calls that wait for
#: something to appear, whose timeout the program gives, and a reboot, which waits until the vehicle is back.
MAX_SILENCE = 12.0
WAITING = ("Vehicle.wait_", "Vehicle.reboot", "Vehicle.renumber")
SILENT = [call for call in CALLS if call.silent]
STUCK = [call for call in CALLS if call.stuck]
MONITORED = [call for call in CALLS if call.interrupted]
#: Calls that wait for data without a timeout.
ENDLESS = {"MessageStream.__anext__", "Shell.__anext__"}


async def prepare(harness: ScriptedHarness, call: Call) -> None:
    harness.autopilot.arm(call.armed)
    if call.before:
        await call.before(harness)
    await asyncio.sleep(1.5)


def max_duration(call: Call) -> float:
    return MAX_DURATION if call.name.startswith(WAITING) else MAX_SILENCE


async def failure(
    harness: ScriptedHarness, call: Call, kind: type[MavstackError], within: float = MAX_DURATION
) -> MavstackError:
    """Return the error of the call, within bounded time."""
    begun = asyncio.get_running_loop().time()
    with pytest.raises(kind) as failed:
        await call.do(harness)
    assert asyncio.get_running_loop().time() - begun < within
    return failed.value


@pytest.mark.parametrize("call", SILENT, ids=call_name)
def test_a_vehicle_that_answers_nothing(call):
    async def scenario(harness):
        await prepare(harness, call)
        harness.autopilot.silent = True
        error = await failure(harness, call, RemoteTimeout, max_duration(call))
        assert type(error) is call.silent
        assert isinstance(error, TimeoutError)
        assert "1/1 failed" in str(error)
        if call.silent is not ActionTimeout:
            assert call.operation.partition(" ")[0] in str(error) or error.operation in str(error)

    run_scenario(scenario, **call.options)


@pytest.mark.parametrize("call", STUCK, ids=call_name)
def test_a_vehicle_that_accepts_and_does_nothing(call):
    async def scenario(harness):
        await prepare(harness, call)
        harness.autopilot.executes = call.interrupted and call.stuck[0] is ActionTimeout
        asyncio.get_running_loop().call_later(3.0, harness.autopilot.send_statustext, "motor 2 is weak", 3)
        error = await failure(harness, call, RemoteTimeout)
        kind, text = call.stuck
        assert type(error) is kind
        assert text in str(error)
        if kind is ActionTimeout and call.name != "Vehicle.reboot":
            assert error.status_texts == ("motor 2 is weak",)
            assert str(error).endswith("(motor 2 is weak)")

    run_scenario(scenario, **call.options)


@pytest.mark.parametrize("call", MONITORED, ids=call_name)
def test_a_timeout_of_the_program(call):
    limited = {
        "Vehicle.takeoff": lambda h: h.vehicle.takeoff(30, timeout=5),
        "Vehicle.land": lambda h: h.vehicle.land(timeout=5),
        "Vehicle.rtl": lambda h: h.vehicle.rtl(timeout=5),
        "Vehicle.goto": lambda h: h.vehicle.goto(47.5, 8.5, 20, timeout=5),
        "Vehicle.move": lambda h: h.vehicle.move(east=500, timeout=5),
        "Vehicle.orbit": lambda h: h.vehicle.orbit(47.5, 8.5, timeout=5),
        "Vehicle.set_yaw": lambda h: h.vehicle.set_yaw(90, timeout=5),
        "Mission.fly": lambda h: h.vehicle.mission.fly(timeout=5),
    }[call.name]

    async def scenario(harness):
        await prepare(harness, call)
        begun = harness.connection.now()
        with pytest.raises(ActionTimeout, match=r"not done in 5 s, [0-9]+ (m|degrees|items) to go"):
            await limited(harness)
        assert 5 <= harness.connection.now() - begun < 8

    run_scenario(scenario)


@pytest.mark.parametrize("call", MONITORED, ids=call_name)
def test_silence_during_an_action(call):
    async def scenario(harness):
        await prepare(harness, call)

        def become_silent() -> None:
            harness.autopilot.send_statustext("battery critical", 2)
            harness.autopilot.silent = True

        asyncio.get_running_loop().call_later(4.0, become_silent)
        begun = harness.connection.now()
        error = await failure(harness, call, ContactLost)
        assert harness.connection.now() - begun < 12
        assert "1/1 failed: it fell silent (battery critical)" in str(error)
        harness.autopilot.silent = False
        await asyncio.sleep(2)
        assert harness.vehicle.alive
        await harness.vehicle.set_mode("LOITER")  # the same object still works

    run_scenario(scenario, **call.options)


@pytest.mark.flight_cases(50)
@pytest.mark.fast_cases(40)
@pytest.mark.parametrize("call", [call for call in CALLS if call.name not in ENDLESS], ids=call_name)
@pytest.mark.parametrize("moment", [0.3, 1.1])
def test_silence_at_any_moment_ends_every_call(call, moment):
    """Assert that running calls succeed or raise a typed error, and do not wait for ever."""

    async def scenario(harness):
        await prepare(harness, call)
        asyncio.get_running_loop().call_later(moment, lambda: setattr(harness.autopilot, "silent", True))
        async with asyncio.timeout(moment + max_duration(call)):
            outcome = (await asyncio.gather(call.do(harness), return_exceptions=True))[0]
        if isinstance(outcome, Exception):
            assert isinstance(outcome, RemoteError)
            assert "1/1" in str(outcome)

    run_scenario(scenario, latency=0.25, **call.options)


@pytest.mark.fast_cases(84)
@pytest.mark.parametrize("call", CALLS, ids=call_name)
@pytest.mark.parametrize("moment", [0.0, 0.7])
def test_closing_the_connection_during_a_call(call, moment):
    async def scenario(harness):
        await prepare(harness, call)
        doing = asyncio.create_task(call.do(harness))
        await asyncio.sleep(moment)
        if doing.done():
            return
        await harness.connection.close()
        async with asyncio.timeout(10):
            outcome = (await asyncio.gather(doing, return_exceptions=True))[0]
        ended_well = outcome is None or isinstance(outcome, StopAsyncIteration | bool)
        kind = RemoteError if moment else MavstackError  # at 0 s the call may not have sent its request
        assert ended_well or isinstance(outcome, kind), repr(outcome)
        if call.interrupted and moment:
            assert type(outcome) is RemoteCancelled
            assert "1/1 failed" in str(outcome)

    run_scenario(scenario, latency=0.25, **call.options)


@pytest.mark.fast_cases(55)
@pytest.mark.parametrize("call", [call for call in CALLS if call.name not in ENDLESS], ids=call_name)
def test_the_peer_closes_its_link_during_a_call(call):
    async def scenario(harness):
        await prepare(harness, call)
        doing = asyncio.create_task(call.do(harness))
        await asyncio.sleep(0.7)
        if doing.done():
            return
        await harness.autopilot.close()
        async with asyncio.timeout(MAX_DURATION):
            outcome = (await asyncio.gather(doing, return_exceptions=True))[0]
        assert outcome is None or isinstance(outcome, RemoteError | bool), repr(outcome)
        if call.interrupted:
            assert isinstance(outcome, RemoteTimeout)

    run_scenario(scenario, latency=0.25, **call.options)


@pytest.mark.parametrize(
    "call", [call for call in SILENT if call.name != "GuidedSession.__aexit__"], ids=call_name
)
def test_a_closed_connection_raises_immediately(call):
    async def scenario(harness):
        await prepare(harness, call)
        await harness.connection.close()
        begun = asyncio.get_running_loop().time()
        with pytest.raises(MavstackError, match=r"is not open|was closed"):
            await call.do(harness)
        assert asyncio.get_running_loop().time() - begun < 1

    run_scenario(scenario, **call.options)


def test_a_guided_session_with_a_vehicle_that_falls_silent():
    async def scenario(harness):
        await enter_guided(harness)
        harness.autopilot.silent = True
        await asyncio.sleep(8)
        with pytest.raises(ContactLost, match="following setpoints with 1/1 failed: it fell silent"):
            harness.guided.velocity(1)
        with pytest.raises(RemoteTimeout):
            await harness.guided.__aexit__(None, None, None)

    run_scenario(scenario)


def test_a_guided_session_on_a_closed_connection():
    async def scenario(harness):
        await enter_guided(harness)
        await harness.connection.close()
        with pytest.raises(RemoteCancelled, match=r"following setpoints .*: the connection was closed"):
            harness.guided.velocity(1)
        await harness.guided.__aexit__(None, None, None)

    run_scenario(scenario)


def test_a_reboot_without_acknowledgement_is_not_repeated():
    """A repeated command would reboot the vehicle a second time when it is back."""

    async def scenario(harness):
        requests = []

        def reboot(request):
            requests.append(request)
            harness.autopilot.silent = True
            asyncio.get_running_loop().call_later(12.0, lambda: setattr(harness.autopilot, "silent", False))
            return common.MavResult.ACCEPTED

        harness.autopilot.commands.server.support(CMD.PREFLIGHT_REBOOT_SHUTDOWN, reboot)
        await harness.vehicle.reboot()
        assert harness.vehicle.alive
        received = len(requests)
        await asyncio.sleep(30)
        assert len(requests) == received

    run_scenario(scenario)


def test_a_reboot_without_waiting():
    async def scenario(harness):
        await harness.vehicle.reboot(wait=False)
        harness.autopilot.silent = True
        with pytest.raises(ContactLost, match="rebooting 1/1 failed: it fell silent without an ack"):
            await harness.vehicle.reboot(wait=False)

    run_scenario(scenario)
