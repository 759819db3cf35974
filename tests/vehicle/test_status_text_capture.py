"""The texts of a vehicle as the reasons of an error."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout, LocalProtocolError, ParameterTimeout
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.vehicle.status_text_capture import (
    MAX_TEXTS,
    REASON_TIMEOUT,
    StatusTextCapture,
    attach_status_texts,
    with_status_texts,
)
from mavstack.vehicle.telemetry import StatusText
from tests.vehicle.failures.scripted import CMD, RESULT, SEVERITY, play, run_virtually, scene


async def raises(error, after=0.0):
    await asyncio.sleep(after)
    raise error


def denied():
    return CommandDenied("IT", "1/1", answer="DENIED", code=2)


@pytest.mark.parametrize("severity", list(SEVERITY))
def test_warnings_and_worse_are_reasons(severity):
    async def scenario(made):
        made.script.saying = lambda: made.say("because", severity)
        made.script.refuse(CMD.COMPONENT_ARM_DISARM)
        with pytest.raises(CommandDenied) as error:
            await made.vehicle.arm()
        assert error.value.status_texts == (("because",) if severity <= SEVERITY.WARNING else ())

    play(scenario)


def test_a_refusal_waits_for_its_reason_for_a_limited_time():
    async def scenario(made):
        begun = made.node.now()
        made.say("because", after=0.4)
        with pytest.raises(CommandDenied, match=r"IT 1/1 failed: DENIED \(because\)"):
            await with_status_texts(made.vehicle, raises(denied()))
        assert 0.4 <= made.node.now() - begun < REASON_TIMEOUT
        begun = made.node.now()
        made.say("too late", after=REASON_TIMEOUT + 0.1)
        with pytest.raises(CommandDenied) as error:
            await with_status_texts(made.vehicle, raises(denied()))
        assert error.value.status_texts == ()
        assert made.node.now() - begun == pytest.approx(REASON_TIMEOUT, abs=0.01)

    play(scenario)


def test_texts_before_the_refusal_are_reasons():
    async def scenario(made):
        made.say("because", after=0.1)
        begun = made.node.now()
        with pytest.raises(CommandDenied) as error:
            await with_status_texts(made.vehicle, raises(denied(), after=0.2))
        assert error.value.status_texts == ("because",)
        assert made.node.now() - begun == pytest.approx(0.2, abs=0.01)

    play(scenario)


def test_a_timeout_carries_earlier_texts_and_does_not_wait():
    async def scenario(made):
        made.say("battery low", after=0.1)
        made.say("later", after=0.6)
        begun = made.node.now()
        with pytest.raises(CommandTimeout, match=r"IT 1/1 failed: no answer \(battery low\)"):
            await with_status_texts(made.vehicle, raises(CommandTimeout("IT", "1/1"), after=0.5))
        assert made.node.now() - begun == pytest.approx(0.5, abs=0.01)

    play(scenario)


def test_status_texts_of_an_error_are_kept():
    async def scenario(made):
        error = denied()
        error.status_texts = ("its own",)
        made.say("another", after=0.1)
        with pytest.raises(CommandDenied) as raised:
            await with_status_texts(made.vehicle, raises(error, after=0.2))
        assert raised.value.status_texts == ("its own",)

    play(scenario)


def test_other_errors_and_results_pass_through():
    async def scenario(made):
        before = made.registers()
        with pytest.raises(LocalProtocolError):
            await with_status_texts(made.vehicle, raises(LocalProtocolError("wrong")))
        assert await with_status_texts(made.vehicle, asyncio.sleep(0, "result")) == "result"
        assert made.registers() == before

    play(scenario)


def test_several_texts_of_one_reason():
    async def scenario(made):
        made.say("first", after=0.30)
        made.say("second", after=0.35)
        with pytest.raises(CommandDenied) as error:
            await with_status_texts(made.vehicle, raises(denied()))
        assert error.value.status_texts == ("first", "second")

    play(scenario)


def test_a_capture_keeps_the_last_texts():
    async def scenario(made):
        with StatusTextCapture(made.vehicle) as captured:
            for number in range(50):
                made.say(f"text {number}")
                await asyncio.sleep(0.01)
                assert len(captured.warnings) <= MAX_TEXTS
            assert captured.warnings == tuple(f"text {number}" for number in range(44, 50))

    play(scenario)


def test_texts_of_its_other_components_count_and_other_systems_do_not():
    async def whole() -> None:
        network = MemoryNetwork()
        async with scene(network=network) as made:
            own = Node(network.link(), system=1, component=191)
            other = Node(network.link(), system=2, component=1)
            async with own, other:
                with StatusTextCapture(made.vehicle) as captured:
                    own.send_statustext("of its companion", SEVERITY.ERROR)
                    other.send_statustext("of another vehicle", SEVERITY.ERROR)
                    await asyncio.sleep(0.1)
                    assert captured.warnings == ("of its companion",)

    run_virtually(whole())


def test_a_parameter_timeout_carries_status_texts():
    async def scenario(made):
        await made.vehicle.params.get("P_00")
        made.script._host.engine.remove(made.script.parameters)
        made.say("storage failed", after=0.5)
        made.say("by the way", SEVERITY.INFO, after=0.5)
        with pytest.raises(ParameterTimeout, match="storage failed") as error:
            await made.vehicle.params.get("P_01")
        assert error.value.status_texts == ("storage failed",)

    play(scenario)


def test_attaching_status_texts():
    error = CommandDenied("IT", "1/1", answer="DENIED", code=int(RESULT.DENIED))
    texts = [StatusText(1.0, SEVERITY.ERROR, name, 1) for name in ("a", "b", "c", "d", "e", "f", "g", "b")]
    attach_status_texts(error, [*texts, StatusText(2.0, common.MavSeverity.DEBUG, "z", 1)])
    assert error.status_texts == ("a", "c", "d", "e", "f", "g", "b")[-MAX_TEXTS:]
    attach_status_texts(error, [StatusText(3.0, SEVERITY.ERROR, "another", 1)])
    assert "another" not in error.status_texts
