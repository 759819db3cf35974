"""A vehicle that does something else in the middle of an action: a failsafe, a pilot, another station."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from tests.vehicle.failures.calls import CALLS, enter_guided
from tests.vehicle.failures.rows import named
from tests.vehicle.failures.scripted import ARDUPILOT, PX4, Scene, play, run_virtually, scene

WATCHED = [call for call in CALLS if call.interrupted]
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
ARDUPILOT_CALLS = [call for call in WATCHED if call.name != "Mission.fly"]


async def interrupted(made: Scene, call, happens) -> ActionInterrupted:
    made.script.arm()
    if call.before:
        await call.before(made)
    await asyncio.sleep(1.5)
    loop = asyncio.get_running_loop()
    loop.call_later(5.0, made.script.send_statustext, "Failsafe: battery", 2)
    loop.call_later(5.2, happens)
    begun = made.node.now()
    with pytest.raises(ActionInterrupted) as error:
        await call.do(made)
    assert 6 < made.node.now() - begun < 10
    return error.value


@pytest.mark.parametrize("call", WATCHED, ids=named)
def test_another_mode(call):
    async def scenario(made):
        error = await interrupted(made, call, lambda: made.script.enter("ALTCTL"))
        assert str(error) == f"{OPERATIONS[call.name]} 1/1 failed: it changed to ALTCTL (Failsafe: battery)"
        assert error.status_texts == ("Failsafe: battery",)

    play(scenario, autopilot=PX4)


@pytest.mark.parametrize("call", ARDUPILOT_CALLS, ids=named)
def test_another_mode_of_ardupilots(call):
    async def scenario(made):
        made.script.parameters.add("CIRCLE_OPTIONS", 1)
        error = await interrupted(made, call, lambda: made.script.enter("STABILIZE"))
        operation = OPERATIONS["Vehicle.goto"] if call.name == "Vehicle.orbit" else OPERATIONS[call.name]
        assert str(error) == f"{operation} 1/1 failed: it changed to STABILIZE (Failsafe: battery)"

    play(scenario, autopilot=ARDUPILOT)


@pytest.mark.parametrize("call", [call for call in WATCHED if call.name not in MAY_DISARM], ids=named)
def test_disarmed_in_the_air(call):
    async def scenario(made):
        error = await interrupted(made, call, lambda: made.script.arm(False))
        assert str(error).startswith(f"{OPERATIONS[call.name]} 1/1 failed: it was disarmed ")
        assert str(error).endswith(" m above home (Failsafe: battery)")

    play(scenario)


@pytest.mark.parametrize("call", [call for call in WATCHED if call.name in MAY_DISARM], ids=named)
def test_disarming_ends_a_landing(call):
    async def scenario(made):
        made.script.arm()
        await asyncio.sleep(1.5)
        loop = asyncio.get_running_loop()
        loop.call_later(5.0, made.script.arm, False)
        loop.call_later(9.0, setattr, made.script, "heading", 90.0)
        begun = made.node.now()
        await call.do(made)
        assert 5 <= made.node.now() - begun < 10

    play(scenario)


@pytest.mark.parametrize("call", WATCHED, ids=named)
def test_a_mode_for_a_moment_is_no_interruption(call):
    """Some change their mode before they tell that an action has ended."""

    async def scenario(made):
        made.script.arm()
        if call.before:
            await call.before(made)
        await asyncio.sleep(1.5)
        doing = asyncio.create_task(call.do(made))
        await asyncio.sleep(6)
        mode = made.vehicle.mode
        made.script.enter("ALTCTL")
        await asyncio.sleep(1.0)
        made.script.enter(mode)
        await asyncio.sleep(6)
        assert not doing.done()
        doing.cancel()
        await asyncio.gather(doing, return_exceptions=True)

    play(scenario)


def test_another_station_takes_over():
    async def whole() -> None:
        network = MemoryNetwork()
        async with scene(network=network) as made, Node(network.link(), system=254) as other:
            made.script.arm()
            await asyncio.sleep(1.5)
            going = asyncio.create_task(made.vehicle.goto(47.5, 8.5, 30))
            await asyncio.sleep(6)
            theirs = await other.wait_for_autopilot()
            await theirs.modes.set("RTL")
            with pytest.raises(ActionInterrupted, match="it changed to RTL"):
                await going

    run_virtually(whole())


def test_the_next_setpoint_raises_after_an_interruption():
    async def scenario(made):
        made.script.arm()
        await enter_guided(made)
        guided = made.guided
        guided.velocity(north=1)
        made.say("Failsafe: no RC")
        made.script.enter("RTL")
        await asyncio.sleep(0.5)
        assert guided.interrupted
        for order in (
            lambda: guided.velocity(1),
            lambda: guided.body_velocity(1),
            lambda: guided.position(1, 2, 3),
            lambda: guided.goto(47, 8, 20),
            lambda: guided.attitude(0, 0, 0, 0.5),
            guided.check,
        ):
            with pytest.raises(ActionInterrupted) as error:
                order()
            text = "following setpoints with 1/1 failed: it changed to RTL (Failsafe: no RC)"
            assert str(error.value) == text
        made.script.heard.clear()
        await guided.__aexit__(None, None, None)
        assert not [each for each in made.script.heard if isinstance(each, common.CommandLong)]
        assert made.vehicle.mode == "RTL"

    play(scenario)
