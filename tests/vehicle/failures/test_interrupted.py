"""Actions that a failsafe, a pilot or another ground station interrupts."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from tests.vehicle.failures.calls import CALLS, enter_guided
from tests.vehicle.failures.rows import call_name
from tests.vehicle.failures.scripted_autopilot import (
    ARDUPILOT,
    PX4,
    ScriptedHarness,
    run_scenario,
    run_virtually,
    scripted_harness,
)

MONITORED = [call for call in CALLS if call.interrupted]
#: Landing and returning end with the motors off; a turn needs no motors.
MAY_DISARM = {"Vehicle.land", "Vehicle.rtl", "Vehicle.set_yaw"}
OPERATIONS = {
    "Vehicle.takeoff": "takeoff to 30 m of",
    "Vehicle.land": "landing",
    "Vehicle.rtl": "return to launch of",
    "Vehicle.goto": "going to 47.399000, 8.547000 with",
    "Vehicle.move": "going to 47.398641, 8.545594 with",
    "Vehicle.orbit": "orbit of 20 m radius with",
    "Vehicle.set_yaw": "turn to 90 degrees of",
    "Mission.fly": "flying the mission of",
}
#: The calls that are one step with ArduPilot; an orbit begins with a goto.
ARDUPILOT_CALLS = [call for call in MONITORED if call.name != "Mission.fly"]


async def interrupted(harness: ScriptedHarness, call, interrupt) -> ActionInterrupted:
    harness.autopilot.arm()
    if call.before:
        await call.before(harness)
    await asyncio.sleep(1.5)
    loop = asyncio.get_running_loop()
    loop.call_later(5.0, harness.autopilot.send_statustext, "Failsafe: battery", 2)
    loop.call_later(5.2, interrupt)
    begun = harness.connection.now()
    with pytest.raises(ActionInterrupted) as error:
        await call.do(harness)
    assert 6 < harness.connection.now() - begun < 10
    return error.value


@pytest.mark.parametrize("call", MONITORED, ids=call_name)
def test_another_mode(call):
    async def scenario(harness):
        error = await interrupted(harness, call, lambda: harness.autopilot.enter("ALTCTL"))
        assert str(error) == f"{OPERATIONS[call.name]} 1/1 failed: it changed to ALTCTL (Failsafe: battery)"
        assert error.status_texts == ("Failsafe: battery",)

    run_scenario(scenario, autopilot=PX4)


@pytest.mark.parametrize("call", ARDUPILOT_CALLS, ids=call_name)
def test_another_mode_of_ardupilot(call):
    async def scenario(harness):
        harness.autopilot.parameters.add("CIRCLE_OPTIONS", 1)
        error = await interrupted(harness, call, lambda: harness.autopilot.enter("STABILIZE"))
        operation = OPERATIONS["Vehicle.goto"] if call.name == "Vehicle.orbit" else OPERATIONS[call.name]
        assert str(error) == f"{operation} 1/1 failed: it changed to STABILIZE (Failsafe: battery)"

    run_scenario(scenario, autopilot=ARDUPILOT)


@pytest.mark.parametrize("call", [call for call in MONITORED if call.name not in MAY_DISARM], ids=call_name)
def test_disarmed_in_the_air(call):
    async def scenario(harness):
        error = await interrupted(harness, call, lambda: harness.autopilot.arm(False))
        assert str(error).startswith(f"{OPERATIONS[call.name]} 1/1 failed: it was disarmed ")
        assert str(error).endswith(" m above home (Failsafe: battery)")

    run_scenario(scenario)


@pytest.mark.parametrize("call", [call for call in MONITORED if call.name in MAY_DISARM], ids=call_name)
def test_disarming_ends_a_landing(call):
    async def scenario(harness):
        harness.autopilot.arm()
        await asyncio.sleep(1.5)
        loop = asyncio.get_running_loop()
        loop.call_later(5.0, harness.autopilot.arm, False)
        loop.call_later(9.0, setattr, harness.autopilot, "heading", 90.0)
        begun = harness.connection.now()
        await call.do(harness)
        assert 5 <= harness.connection.now() - begun < 10

    run_scenario(scenario)


@pytest.mark.parametrize("call", MONITORED, ids=call_name)
def test_a_mode_for_a_moment_is_no_interruption(call):
    """Some firmwares change the mode shortly before they report that an action has ended."""

    async def scenario(harness):
        harness.autopilot.arm()
        if call.before:
            await call.before(harness)
        await asyncio.sleep(1.5)
        doing = asyncio.create_task(call.do(harness))
        await asyncio.sleep(6)
        mode = harness.vehicle.mode
        harness.autopilot.enter("ALTCTL")
        await asyncio.sleep(1.0)
        harness.autopilot.enter(mode)
        await asyncio.sleep(6)
        assert not doing.done()
        doing.cancel()
        await asyncio.gather(doing, return_exceptions=True)

    run_scenario(scenario)


def test_another_station_takes_over():
    async def run() -> None:
        network = MemoryNetwork()
        async with scripted_harness(network=network) as harness, Node(network.link(), system=254) as other:
            harness.autopilot.arm()
            await asyncio.sleep(1.5)
            going = asyncio.create_task(harness.vehicle.goto(47.5, 8.5, 30))
            await asyncio.sleep(6)
            autopilot = await other.wait_for_autopilot()
            await autopilot.modes.set("RTL")
            with pytest.raises(ActionInterrupted, match="it changed to RTL"):
                await going

    run_virtually(run())


def test_the_next_setpoint_raises_after_an_interruption():
    async def scenario(harness):
        harness.autopilot.arm()
        await enter_guided(harness)
        guided = harness.guided
        guided.velocity(north=1)
        harness.send_statustext("Failsafe: no RC")
        harness.autopilot.enter("RTL")
        await asyncio.sleep(0.5)
        assert guided.interrupted
        for set_setpoint in (
            lambda: guided.velocity(1),
            lambda: guided.body_velocity(1),
            lambda: guided.position(1, 2, 3),
            lambda: guided.goto(47, 8, 20),
            lambda: guided.attitude(0, 0, 0, 0.5),
            guided.check,
        ):
            with pytest.raises(ActionInterrupted) as error:
                set_setpoint()
            text = "following setpoints with 1/1 failed: it changed to RTL (Failsafe: no RC)"
            assert str(error.value) == text
        harness.autopilot.received.clear()
        await guided.__aexit__(None, None, None)
        assert not [each for each in harness.autopilot.received if isinstance(each, common.CommandLong)]
        assert harness.vehicle.mode == "RTL"

    run_scenario(scenario)
