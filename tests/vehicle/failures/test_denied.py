"""A refusal raises its typed error, with the vehicle's status text in its text."""

from __future__ import annotations

import asyncio
import pickle

import pytest

from mavstack.errors import CommandDenied, RemoteDenied
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from tests.vehicle.failures.calls import CALLS
from tests.vehicle.failures.rows import Call, named
from tests.vehicle.failures.scripted import (
    ARDUPILOT,
    CMD,
    RESULT,
    SEVERITY,
    Scene,
    play,
    run_virtually,
    scene,
)

REASON = "Refused: high drop over the fence"
LONG = "Refused: " + ", ".join(f"sensor {number} has not settled" for number in range(8))
REFUSED = [call for call in CALLS if call.refuse]
WAITING = [call for call in REFUSED if call.waits]


async def make(made: Scene, call: Call, code: int) -> None:
    """Have a call refused for its code."""
    made.script.arm(call.armed)
    if call.before:
        await call.before(made)
    await asyncio.sleep(0.1)
    call.refuse(made, code)


async def denial(made: Scene, call: Call) -> RemoteDenied:
    with pytest.raises(RemoteDenied) as denied:
        async with asyncio.timeout(60):
            await call.do(made)
    return denied.value


def check(call: Call, error: RemoteDenied, code: int, said: tuple[str, ...]) -> None:
    assert type(error) is call.denied
    assert error.code == code
    assert error.status_texts == said
    text = str(error)
    assert call.asked in text
    assert "1/1 failed" in text
    assert all(part in text for part in said)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.code, again.status_texts) == (text, code, said)


def says_before(made: Scene, text: str) -> None:
    made.script.saying = lambda: made.say(text)
    made.script.sayer.text = text


@pytest.mark.fast_cases(55)
@pytest.mark.parametrize("call", REFUSED, ids=named)
@pytest.mark.parametrize("text", [REASON, LONG], ids=["short", "long"])
def test_a_reason_before_the_refusal(call, text):
    async def scenario(made):
        code = call.codes[0]
        await make(made, call, code)
        says_before(made, text)
        error = await denial(made, call)
        check(call, error, code, (text,))
        if call.denied is CommandDenied:
            assert RESULT(code).name in str(error)

    play(scenario, **call.options)


@pytest.mark.parametrize("call", WAITING, ids=named)
def test_a_reason_after_the_refusal(call):
    async def scenario(made):
        code = call.codes[-1]
        await make(made, call, code)
        texts = [REASON, LONG]

        def later() -> None:
            while texts:
                made.say(texts[0], after=0.3 if texts.pop(0) == REASON else 0.35)

        made.script.saying = later
        if call.denied is not CommandDenied:
            made.script.add_packet_listener(tuple(made.script.requests), lambda packet: later())
        check(call, await denial(made, call), code, (REASON, LONG))

    play(scenario, **call.options)


@pytest.mark.fast_cases(95)
@pytest.mark.parametrize(
    ("call", "code"),
    [(call, code) for call in REFUSED for code in call.codes],
    ids=lambda value: value.name if isinstance(value, Call) else str(int(value)),
)
def test_each_code_without_a_reason(call, code):
    async def scenario(made):
        await make(made, call, code)
        begun = made.node.now()
        check(call, await denial(made, call), code, ())
        assert made.node.now() - begun < 20

    play(scenario, **call.options)


@pytest.mark.parametrize("call", REFUSED, ids=named)
def test_texts_that_are_no_reasons(call):
    """An older text, another system's, and what is said by the way."""

    async def whole() -> None:
        network = MemoryNetwork()
        async with (
            scene(network=network, **call.options) as made,
            Node(network.link(), system=9, component=1) as other,
        ):
            await make(made, call, call.codes[0])
            made.say("long ago")
            await asyncio.sleep(2)

            def chatter() -> None:
                made.say("by the way", SEVERITY.INFO)
                made.say("noticed", SEVERITY.NOTICE)
                other.send_statustext("of another", SEVERITY.CRITICAL)

            made.script.saying = chatter
            made.script.add_packet_listener(tuple(made.script.requests), lambda packet: chatter())
            check(call, await denial(made, call), call.codes[0], ())

    run_virtually(whole())


def test_each_text_once_and_the_last_ones():
    async def scenario(made):
        def talk() -> None:
            for number in range(9):
                made.say(f"warning {number}")
            made.say("warning 4")

        made.script.refuse(CMD.COMPONENT_ARM_DISARM)
        made.script.saying = talk
        with pytest.raises(CommandDenied) as denied:
            await made.vehicle.arm()
        assert denied.value.status_texts == tuple(f"warning {number}" for number in (3, 5, 6, 7, 8, 4))

    play(scenario)


def test_ardupilots_text_for_a_refused_mode():
    async def scenario(made):
        made.script.modes._may_enter = lambda mode, source: "requires position"
        with pytest.raises(CommandDenied) as denied:
            await made.vehicle.takeoff(10)
        assert denied.value.code == RESULT.FAILED
        assert str(denied.value) == "DO_SET_MODE on 1/1 failed: FAILED (Mode refused: requires position)"

    play(scenario, autopilot=ARDUPILOT)


def test_an_unknown_mode():
    async def scenario(made):
        with pytest.raises(
            RemoteDenied,
            match=r"setting mode SIDEWAYS on 1/1 failed: there is no such mode; the vehicle has .*RTL",
        ):
            await made.vehicle.set_mode("SIDEWAYS")

    play(scenario)


def test_closing_ends_the_wait_for_a_reason():
    async def scenario(made):
        made.script.refuse(CMD.COMPONENT_ARM_DISARM)
        begun = asyncio.get_running_loop().time()
        arming = asyncio.create_task(made.vehicle.arm())
        await asyncio.sleep(0.2)
        assert not arming.done()
        await made.node.close()
        with pytest.raises(CommandDenied):
            await arming
        assert asyncio.get_running_loop().time() - begun < 0.5

    play(scenario)
