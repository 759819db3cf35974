"""Watching an action: progress, limits, settling, straying."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import ActionInterrupted, ActionTimeout
from mavstack.vehicle.action_monitor import AFTER_ALL, PATIENCE, SETTLING, TOLD_BY, ActionGoal, ActionMonitor
from tests.vehicle.failures.scripted import play


async def watched(made, aim):
    """How long it was watched, in seconds, and what it ended with."""
    begun = made.node.now()
    async with ActionMonitor(made.vehicle) as watch:
        try:
            await watch.until(aim)
        except (ActionInterrupted, ActionTimeout) as error:
            return made.node.now() - begun, error
    return made.node.now() - begun, None


def test_what_is_reached_already_is_not_waited_for():
    async def scenario(made):
        assert await watched(made, ActionGoal("it", lambda: True, limit=0.0)) == (0.0, None)

    play(scenario)


def test_it_looks_at_each_message_that_comes():
    async def scenario(made):
        done_at = made.node.now() + 2.0
        asyncio.get_running_loop().call_later(2.0, made.say, "a message")
        took, error = await watched(made, ActionGoal("it", lambda: made.node.now() >= done_at))
        assert error is None
        assert took == pytest.approx(2.0, abs=0.01)

    play(scenario)


@pytest.mark.parametrize(
    ("step", "every", "goes_on"), [(0.6, 20.0, True), (0.4, 60.0, False), (-1, 5, False)]
)
def test_progress_renews_patience(step, every, goes_on):
    async def scenario(made):
        begun = made.node.now()

        def left():
            return 1000.0 - step * ((made.node.now() - begun) // every)

        took, error = await watched(made, ActionGoal("it", lambda: made.node.now() > begun + 100, left))
        if goes_on:
            assert error is None
            assert took > 100
        else:
            assert took == pytest.approx(PATIENCE, abs=0.6)
            assert "it 1/1 failed: got no further for 30 s, 1" in str(error)
            assert str(error).endswith("m to go")

    play(scenario)


def test_without_a_measure_only_patience_counts():
    async def scenario(made):
        took, error = await watched(made, ActionGoal("it", lambda: False, patience=7.0))
        assert took == pytest.approx(7.0, abs=0.6)
        assert str(error) == "it 1/1 failed: got no further for 7 s"

    play(scenario)


def test_small_steps_add_up():
    async def scenario(made):
        begun = made.node.now()
        aim = ActionGoal("it", lambda: made.node.now() > begun + 90, lambda: 100.0 - (made.node.now() - begun) / 20)
        assert (await watched(made, aim))[1] is None

    play(scenario)


def test_a_limit_counts_whatever_gets_on():
    async def scenario(made):
        begun = made.node.now()
        aim = ActionGoal("it", lambda: False, lambda: 1000 - 5 * (made.node.now() - begun), limit=12.0, unit="items")
        took, error = await watched(made, aim)
        assert took == pytest.approx(12.0, abs=0.6)
        assert str(error) == "it 1/1 failed: not done in 12 s, 940 items to go"

    play(scenario)


@pytest.mark.parametrize(("for_long", "interrupted"), [(SETTLING + 0.5, False), (SETTLING + 4, True)])
def test_the_mode_may_settle(for_long, interrupted):
    async def scenario(made):
        asyncio.get_running_loop().call_later(for_long, made.script.enter, "LAND")
        aim = ActionGoal("it", lambda: False, modes={"land"}, limit=15.0)
        took, error = await watched(made, aim)
        assert type(error) is (ActionInterrupted if interrupted else ActionTimeout)
        if interrupted:
            assert SETTLING + AFTER_ALL <= took < SETTLING + AFTER_ALL + 0.6
            assert str(error) == "it 1/1 failed: it changed to LOITER"

    play(scenario)


def test_straying_now_and_then_does_not_add_up():
    async def scenario(made):
        async def flicker() -> None:
            for _ in range(8):
                made.script.enter("ALTCTL")
                await asyncio.sleep(1.2)
                made.script.enter("LOITER")
                await asyncio.sleep(0.6)

        flickering = asyncio.create_task(flicker())
        _, error = await watched(made, ActionGoal("it", lambda: False, modes={"loiter"}, limit=13.0))
        assert type(error) is ActionTimeout
        await flickering

    play(scenario)


@pytest.mark.parametrize("wanted", [True, False])
def test_armed_or_disarmed_instead(wanted):
    async def scenario(made):
        made.script.arm(wanted)
        await asyncio.sleep(1)
        asyncio.get_running_loop().call_later(6.0, made.script.arm, not wanted)
        _, error = await watched(made, ActionGoal("it", lambda: False, armed=wanted, limit=20))
        assert str(error) == f"it 1/1 failed: it was {'disarmed' if wanted else 'armed'}"

    play(scenario)


def test_what_was_told_before_is_not_told_again():
    async def scenario(made):
        made.say("before")
        await asyncio.sleep(0.5)
        asyncio.get_running_loop().call_later(1.0, made.say, "meanwhile")
        _, error = await watched(made, ActionGoal("it", lambda: False, limit=3.0))
        assert error.status_texts == ("meanwhile",)

    play(scenario)


def test_it_asks_for_what_tells_how_it_gets_on():
    async def scenario(made):
        for kind in TOLD_BY:
            made.script.message_server.set_interval(kind, 0.0, made.script.now())
        await asyncio.sleep(5)
        age = made.vehicle.age(next(iter(TOLD_BY)))
        assert age > 4
        async with ActionMonitor(made.vehicle):
            await asyncio.sleep(1)
            assert all(made.vehicle.age(kind) <= 0.51 for kind in TOLD_BY)

    play(scenario)


def test_a_watch_that_is_not_entered_leaves_nothing():
    async def scenario(made):
        async def watch() -> None:
            async with ActionMonitor(made.vehicle):
                pytest.fail("it was not to be entered")

        for kind in TOLD_BY:
            made.script.message_server.set_interval(kind, 0.0, made.script.now())
        await asyncio.sleep(5)
        made.script.commands.server.support(511, lambda request: None)  # SET_MESSAGE_INTERVAL, never done
        held = made.vehicle.telemetry.rates
        for kind, rate in TOLD_BY.items():
            held.hold(kind, rate)
        await asyncio.sleep(0.1)
        before = made.registers()
        watching = asyncio.create_task(watch())
        await asyncio.sleep(0.5)
        assert made.registers()["listening"] > before["listening"]
        watching.cancel()
        with pytest.raises(asyncio.CancelledError):
            await watching
        after = made.registers()
        assert {key: after[key] for key in ("listening", "events")} == {
            key: before[key] for key in ("listening", "events")
        }

    play(scenario)
