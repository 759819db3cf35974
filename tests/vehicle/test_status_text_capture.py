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
from tests.vehicle.failures.scripted_autopilot import (
    CMD,
    RESULT,
    SEVERITY,
    run_scenario,
    run_virtually,
    scripted_harness,
)


async def raises(error, after=0.0):
    await asyncio.sleep(after)
    raise error


def denied():
    return CommandDenied("IT", "1/1", answer="DENIED", code=2)


@pytest.mark.parametrize("severity", list(SEVERITY))
def test_texts_of_a_refusal_are_reasons(severity):
    async def scenario(harness):
        harness.autopilot.on_refusal = lambda: harness.send_statustext("because", severity)
        harness.autopilot.refuse(CMD.COMPONENT_ARM_DISARM)
        with pytest.raises(CommandDenied) as error:
            await harness.vehicle.arm()
        assert error.value.status_texts == (("because",) if severity <= SEVERITY.INFO else ())

    run_scenario(scenario)


def test_a_warning_is_a_better_reason_than_a_remark():
    async def scenario(harness):
        harness.autopilot.refuse(CMD.COMPONENT_ARM_DISARM)
        harness.autopilot.on_refusal = lambda: harness.send_statustext("mission changed", SEVERITY.INFO)
        harness.send_statustext("because", after=0.3)
        with pytest.raises(CommandDenied) as error:
            await harness.vehicle.arm()
        assert error.value.status_texts == ("because",)
        harness.autopilot.on_refusal = lambda: harness.send_statustext("later", SEVERITY.INFO, after=0.2)
        with pytest.raises(CommandDenied) as error:
            await harness.vehicle.arm()
        assert error.value.status_texts == ()

    run_scenario(scenario)


def test_a_refusal_waits_for_its_reason_for_a_limited_time():
    async def scenario(harness):
        begun = harness.connection.now()
        harness.send_statustext("because", after=0.4)
        with pytest.raises(CommandDenied, match=r"IT 1/1 failed: DENIED \(because\)"):
            await with_status_texts(harness.vehicle, raises(denied()))
        assert 0.4 <= harness.connection.now() - begun < REASON_TIMEOUT
        begun = harness.connection.now()
        harness.send_statustext("too late", after=REASON_TIMEOUT + 0.1)
        with pytest.raises(CommandDenied) as error:
            await with_status_texts(harness.vehicle, raises(denied()))
        assert error.value.status_texts == ()
        assert harness.connection.now() - begun == pytest.approx(REASON_TIMEOUT, abs=0.01)

    run_scenario(scenario)


def test_texts_before_the_refusal_are_reasons():
    async def scenario(harness):
        harness.send_statustext("because", after=0.1)
        begun = harness.connection.now()
        with pytest.raises(CommandDenied) as error:
            await with_status_texts(harness.vehicle, raises(denied(), after=0.2))
        assert error.value.status_texts == ("because",)
        assert harness.connection.now() - begun == pytest.approx(0.2, abs=0.01)

    run_scenario(scenario)


def test_a_timeout_carries_earlier_texts_and_does_not_wait():
    async def scenario(harness):
        harness.send_statustext("battery low", after=0.1)
        harness.send_statustext("later", after=0.6)
        begun = harness.connection.now()
        with pytest.raises(CommandTimeout, match=r"IT 1/1 failed: no answer \(battery low\)"):
            await with_status_texts(harness.vehicle, raises(CommandTimeout("IT", "1/1"), after=0.5))
        assert harness.connection.now() - begun == pytest.approx(0.5, abs=0.01)

    run_scenario(scenario)


def test_status_texts_of_an_error_are_kept():
    async def scenario(harness):
        error = denied()
        error.status_texts = ("its own",)
        harness.send_statustext("another", after=0.1)
        with pytest.raises(CommandDenied) as raised:
            await with_status_texts(harness.vehicle, raises(error, after=0.2))
        assert raised.value.status_texts == ("its own",)

    run_scenario(scenario)


def test_other_errors_and_results_pass_through():
    async def scenario(harness):
        before = harness.open_resources()
        with pytest.raises(LocalProtocolError):
            await with_status_texts(harness.vehicle, raises(LocalProtocolError("wrong")))
        assert await with_status_texts(harness.vehicle, asyncio.sleep(0, "result")) == "result"
        assert harness.open_resources() == before

    run_scenario(scenario)


def test_several_texts_of_one_reason():
    async def scenario(harness):
        harness.send_statustext("first", after=0.30)
        harness.send_statustext("second", after=0.35)
        with pytest.raises(CommandDenied) as error:
            await with_status_texts(harness.vehicle, raises(denied()))
        assert error.value.status_texts == ("first", "second")

    run_scenario(scenario)


def test_a_capture_keeps_the_last_texts():
    async def scenario(harness):
        with StatusTextCapture(harness.vehicle) as captured:
            for number in range(50):
                harness.send_statustext(f"text {number}")
                await asyncio.sleep(0.01)
                assert len(captured.warnings) <= MAX_TEXTS
            assert captured.warnings == tuple(f"text {number}" for number in range(44, 50))

    run_scenario(scenario)


def test_texts_of_its_other_components_count_and_other_systems_do_not():
    async def whole() -> None:
        network = MemoryNetwork()
        async with scripted_harness(network=network) as harness:
            own = Node(network.link(), system=1, component=191)
            other = Node(network.link(), system=2, component=1)
            async with own, other:
                with StatusTextCapture(harness.vehicle) as captured:
                    own.send_statustext("of its companion", SEVERITY.ERROR)
                    other.send_statustext("of another vehicle", SEVERITY.ERROR)
                    await asyncio.sleep(0.1)
                    assert captured.warnings == ("of its companion",)

    run_virtually(whole())


def test_a_parameter_timeout_carries_status_texts():
    async def scenario(harness):
        await harness.vehicle.params.get("P_00")
        harness.autopilot._host.engine.remove(harness.autopilot.parameters)
        harness.send_statustext("storage failed", after=0.5)
        harness.send_statustext("by the way", SEVERITY.INFO, after=0.5)
        with pytest.raises(ParameterTimeout, match="storage failed") as error:
            await harness.vehicle.params.get("P_01")
        assert error.value.status_texts == ("storage failed",)

    run_scenario(scenario)


def test_attaching_status_texts():
    error = CommandDenied("IT", "1/1", answer="DENIED", code=int(RESULT.DENIED))
    texts = [StatusText(1.0, SEVERITY.ERROR, name, 1) for name in ("a", "b", "c", "d", "e", "f", "g", "b")]
    attach_status_texts(error, [*texts, StatusText(2.0, common.MavSeverity.DEBUG, "z", 1)])
    assert error.status_texts == ("a", "c", "d", "e", "f", "g", "b")[-MAX_TEXTS:]
    attach_status_texts(error, [StatusText(3.0, SEVERITY.ERROR, "another", 1)])
    assert "another" not in error.status_texts
