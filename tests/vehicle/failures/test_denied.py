"""A refusal raises its typed error, with the vehicle's status text in its text."""

from __future__ import annotations

import asyncio
import pickle

import pytest

from mavstack.errors import CommandDenied, RemoteDenied
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from tests.vehicle.failures.calls import CALLS
from tests.vehicle.failures.rows import Call, call_name
from tests.vehicle.failures.scripted_autopilot import (
    ARDUPILOT,
    CMD,
    REQUEST_MESSAGES,
    RESULT,
    SEVERITY,
    ScriptedHarness,
    run_scenario,
    run_virtually,
    scripted_harness,
)

REASON = "Refused: high drop over the fence"
LONG = "Refused: " + ", ".join(f"sensor {number} has not settled" for number in range(8))
REFUSED = [call for call in CALLS if call.refuse]
WAITING = [call for call in REFUSED if call.waits]


async def prepare_refusal(harness: ScriptedHarness, call: Call, code: int) -> None:
    """Make the vehicle refuse the call with this result."""
    harness.autopilot.arm(call.armed)
    if call.before:
        await call.before(harness)
    await asyncio.sleep(0.1)
    call.refuse(harness, code)


async def denial(harness: ScriptedHarness, call: Call) -> RemoteDenied:
    with pytest.raises(RemoteDenied) as denied:
        async with asyncio.timeout(60):
            await call.do(harness)
    return denied.value


def check(call: Call, error: RemoteDenied, code: int, status_texts: tuple[str, ...]) -> None:
    assert type(error) is call.denied
    assert error.code == code
    assert error.status_texts == status_texts
    text = str(error)
    assert call.operation in text
    assert "1/1 failed" in text
    assert all(part in text for part in status_texts)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.code, again.status_texts) == (text, code, status_texts)


def send_text_before_refusal(harness: ScriptedHarness, text: str) -> None:
    harness.autopilot.on_refusal = lambda: harness.send_statustext(text)
    harness.autopilot.status_text_on_request.text = text


@pytest.mark.fast_cases(55)
@pytest.mark.parametrize("call", REFUSED, ids=call_name)
@pytest.mark.parametrize("text", [REASON, LONG], ids=["short", "long"])
def test_a_reason_before_the_refusal(call, text):
    async def scenario(harness):
        code = call.codes[0]
        await prepare_refusal(harness, call, code)
        send_text_before_refusal(harness, text)
        error = await denial(harness, call)
        check(call, error, code, (text,))
        if call.denied is CommandDenied:
            assert RESULT(code).name in str(error)

    run_scenario(scenario, **call.options)


@pytest.mark.parametrize("call", WAITING, ids=call_name)
def test_a_reason_after_the_refusal(call):
    async def scenario(harness):
        code = call.codes[-1]
        await prepare_refusal(harness, call, code)
        texts = [REASON, LONG]

        def later() -> None:
            while texts:
                harness.send_statustext(texts[0], after=0.3 if texts.pop(0) == REASON else 0.35)

        harness.autopilot.on_refusal = later
        if call.denied is not CommandDenied:
            harness.autopilot.add_packet_listener(REQUEST_MESSAGES, lambda packet: later())
        check(call, await denial(harness, call), code, (REASON, LONG))

    run_scenario(scenario, **call.options)


@pytest.mark.fast_cases(95)
@pytest.mark.parametrize(
    ("call", "code"),
    [(call, code) for call in REFUSED for code in call.codes],
    ids=lambda value: value.name if isinstance(value, Call) else str(int(value)),
)
def test_each_code_without_a_reason(call, code):
    async def scenario(harness):
        await prepare_refusal(harness, call, code)
        begun = harness.connection.now()
        check(call, await denial(harness, call), code, ())
        assert harness.connection.now() - begun < 20

    run_scenario(scenario, **call.options)


@pytest.mark.parametrize("call", REFUSED, ids=call_name)
def test_texts_that_are_no_reasons(call):
    """An older text, the text of another system, a debug text and a later information are no reasons."""

    async def run() -> None:
        network = MemoryNetwork()
        async with (
            scripted_harness(network=network, **call.options) as harness,
            Node(network.link(), system=9, component=1) as other,
        ):
            await prepare_refusal(harness, call, call.codes[0])
            harness.send_statustext("long ago")
            await asyncio.sleep(2)

            def send_unrelated_texts() -> None:
                harness.send_statustext("debug", SEVERITY.DEBUG)
                harness.send_statustext("information", SEVERITY.INFO, after=0.3)
                other.send_statustext("of another", SEVERITY.CRITICAL)

            harness.autopilot.on_refusal = send_unrelated_texts
            harness.autopilot.add_packet_listener(REQUEST_MESSAGES, lambda packet: send_unrelated_texts())
            check(call, await denial(harness, call), call.codes[0], ())

    run_virtually(run())


def test_each_text_once_and_the_last_ones():
    async def scenario(harness):
        def talk() -> None:
            for number in range(9):
                harness.send_statustext(f"warning {number}")
            harness.send_statustext("warning 4")

        harness.autopilot.refuse(CMD.COMPONENT_ARM_DISARM)
        harness.autopilot.on_refusal = talk
        with pytest.raises(CommandDenied) as denied:
            await harness.vehicle.arm()
        assert denied.value.status_texts == tuple(f"warning {number}" for number in (3, 5, 6, 7, 8, 4))

    run_scenario(scenario)


def test_ardupilots_text_for_a_refused_mode():
    async def scenario(harness):
        harness.autopilot.modes._may_enter = lambda mode, source: "requires position"
        harness.autopilot.land()
        await asyncio.sleep(1)
        with pytest.raises(CommandDenied) as denied:
            await harness.vehicle.takeoff(10)
        assert denied.value.code == RESULT.FAILED
        assert str(denied.value) == "DO_SET_MODE on 1/1 failed: FAILED (Mode refused: requires position)"

    run_scenario(scenario, autopilot=ARDUPILOT)


def test_an_unknown_mode():
    async def scenario(harness):
        with pytest.raises(
            RemoteDenied,
            match=r"setting mode SIDEWAYS on 1/1 failed: there is no such mode; the vehicle has .*RTL",
        ):
            await harness.vehicle.set_mode("SIDEWAYS")

    run_scenario(scenario)


def test_closing_ends_the_wait_for_a_reason():
    async def scenario(harness):
        harness.autopilot.refuse(CMD.COMPONENT_ARM_DISARM)
        begun = asyncio.get_running_loop().time()
        arming = asyncio.create_task(harness.vehicle.arm())
        await asyncio.sleep(0.2)
        assert not arming.done()
        await harness.connection.close()
        with pytest.raises(CommandDenied):
            await arming
        assert asyncio.get_running_loop().time() - begun < 0.5

    run_scenario(scenario)
