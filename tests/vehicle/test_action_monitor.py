"""Monitoring an action: progress, timeouts, settling, interruptions."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import ActionInterrupted, ActionTimeout
from mavstack.vehicle.action_monitor import (
    INTERRUPTION_DELAY,
    MONITORED_RATES,
    SETTLING_TIME,
    STALL_TIMEOUT,
    ActionGoal,
    ActionMonitor,
)
from tests.vehicle.failures.scripted_autopilot import CMD, run_scenario


async def monitored(harness, goal, seconds=None):
    """Return how long an action was monitored, in seconds, and the error that it ended with."""
    begun = harness.connection.now()
    try:
        async with ActionMonitor(harness.vehicle, "work on", seconds) as monitor:
            await monitor.wait_until_reached(goal)
    except (ActionInterrupted, ActionTimeout) as error:
        return harness.connection.now() - begun, error
    return harness.connection.now() - begun, None


def test_a_goal_that_is_reached_needs_no_wait():
    async def scenario(harness):
        assert await monitored(harness, ActionGoal(lambda: True), seconds=1.0) == (0.0, None)

    run_scenario(scenario)


def test_the_goal_is_checked_at_each_message():
    async def scenario(harness):
        done_at = harness.connection.now() + 2.0
        asyncio.get_running_loop().call_later(2.0, harness.send_statustext, "a message")
        took, error = await monitored(harness, ActionGoal(lambda: harness.connection.now() >= done_at))
        assert error is None
        assert took == pytest.approx(2.0, abs=0.01)

    run_scenario(scenario)


@pytest.mark.parametrize(
    ("step", "every", "continues"), [(0.6, 20.0, True), (0.4, 60.0, False), (-1, 5, False)]
)
def test_progress_restarts_the_stall_timeout(step, every, continues):
    async def scenario(harness):
        begun = harness.connection.now()

        def left():
            return 1000.0 - step * ((harness.connection.now() - begun) // every)

        took, error = await monitored(
            harness, ActionGoal(lambda: harness.connection.now() > begun + 100, left)
        )
        if continues:
            assert error is None
            assert took > 100
        else:
            assert took == pytest.approx(STALL_TIMEOUT, abs=0.6)
            assert "work on 1/1 failed: no progress for 30 s, 1" in str(error)
            assert str(error).endswith("m to go")

    run_scenario(scenario)


def test_without_a_measure_only_the_stall_timeout_counts():
    async def scenario(harness):
        took, error = await monitored(harness, ActionGoal(lambda: False, stall_timeout=7.0))
        assert took == pytest.approx(7.0, abs=0.6)
        assert str(error) == "work on 1/1 failed: no progress for 7 s"

    run_scenario(scenario)


def test_small_steps_add_up():
    async def scenario(harness):
        begun = harness.connection.now()
        goal = ActionGoal(
            lambda: harness.connection.now() > begun + 90,
            lambda: 100.0 - (harness.connection.now() - begun) / 20,
        )
        assert (await monitored(harness, goal))[1] is None

    run_scenario(scenario)


def test_the_timeout_also_ends_an_action_that_progresses():
    async def scenario(harness):
        begun = harness.connection.now()
        goal = ActionGoal(lambda: False, lambda: 1000 - 5 * (harness.connection.now() - begun), unit="items")
        took, error = await monitored(harness, goal, seconds=12.0)
        assert took == pytest.approx(12.0, abs=0.6)
        assert str(error) == "work on 1/1 failed: not done in 12 s, 940 items to go"

    run_scenario(scenario)


@pytest.mark.parametrize(
    ("for_long", "interrupted"), [(SETTLING_TIME + 0.5, False), (SETTLING_TIME + 4, True)]
)
def test_the_mode_may_settle(for_long, interrupted):
    async def scenario(harness):
        asyncio.get_running_loop().call_later(for_long, harness.autopilot.enter, "LAND")
        goal = ActionGoal(lambda: False, modes={"land"})
        took, error = await monitored(harness, goal, seconds=15.0)
        assert type(error) is (ActionInterrupted if interrupted else ActionTimeout)
        if interrupted:
            earliest = SETTLING_TIME + INTERRUPTION_DELAY
            assert earliest <= took < earliest + 0.6
            assert str(error) == "work on 1/1 failed: it changed to LOITER"

    run_scenario(scenario)


def test_short_mode_changes_do_not_add_up():
    async def scenario(harness):
        async def flicker() -> None:
            for _ in range(8):
                harness.autopilot.enter("ALTCTL")
                await asyncio.sleep(1.2)
                harness.autopilot.enter("LOITER")
                await asyncio.sleep(0.6)

        flickering = asyncio.create_task(flicker())
        _, error = await monitored(harness, ActionGoal(lambda: False, modes={"loiter"}), seconds=13.0)
        assert type(error) is ActionTimeout
        await flickering

    run_scenario(scenario)


@pytest.mark.parametrize("wanted", [True, False])
def test_armed_or_disarmed_instead(wanted):
    async def scenario(harness):
        harness.autopilot.arm(wanted)
        await asyncio.sleep(1)
        asyncio.get_running_loop().call_later(6.0, harness.autopilot.arm, not wanted)
        _, error = await monitored(harness, ActionGoal(lambda: False, armed=wanted), seconds=20)
        reason = "disarmed 20 m above home" if wanted else "armed"
        assert str(error) == f"work on 1/1 failed: it was {reason}"

    run_scenario(scenario)


def test_a_vehicle_that_was_never_armed():
    async def scenario(harness):
        harness.autopilot.arm(False)
        await asyncio.sleep(1)
        _, error = await monitored(harness, ActionGoal(lambda: False, armed=True), seconds=20)
        assert str(error) == "work on 1/1 failed: it is not armed"

    run_scenario(scenario)


def test_earlier_status_texts_are_not_attached():
    async def scenario(harness):
        harness.send_statustext("before")
        await asyncio.sleep(0.5)
        asyncio.get_running_loop().call_later(1.0, harness.send_statustext, "meanwhile")
        _, error = await monitored(harness, ActionGoal(lambda: False), seconds=3.0)
        assert error.status_texts == ("meanwhile",)

    run_scenario(scenario)


def test_the_messages_that_report_progress_are_requested():
    async def scenario(harness):
        for kind in MONITORED_RATES:
            harness.autopilot.message_server.set_interval(kind, 0.0, harness.autopilot.now())
        await asyncio.sleep(5)
        age = harness.vehicle.age(next(iter(MONITORED_RATES)))
        assert age > 4
        async with ActionMonitor(harness.vehicle, "work on"):
            await asyncio.sleep(1)
            assert all(harness.vehicle.age(message) <= 0.51 for message in MONITORED_RATES)

    run_scenario(scenario)


def test_a_monitor_that_was_not_entered_leaves_nothing_registered():
    async def scenario(harness):
        async def watch() -> None:
            async with ActionMonitor(harness.vehicle, "work on"):
                pytest.fail("the monitor must not be entered")

        for kind in MONITORED_RATES:
            harness.autopilot.message_server.set_interval(kind, 0.0, harness.autopilot.now())
        await asyncio.sleep(5)
        # The command SET_MESSAGE_INTERVAL is never completed.
        harness.autopilot.commands.server.support(CMD.SET_MESSAGE_INTERVAL, lambda request: None)
        held = harness.vehicle.telemetry.rates
        for kind, rate in MONITORED_RATES.items():
            held.hold(kind, rate)
        await asyncio.sleep(0.1)
        before = harness.open_resources()
        watching = asyncio.create_task(watch())
        await asyncio.sleep(0.5)
        assert harness.open_resources()["packet listeners"] > before["packet listeners"]
        watching.cancel()
        with pytest.raises(asyncio.CancelledError):
            await watching
        after = harness.open_resources()
        assert {key: after[key] for key in ("packet listeners", "event listeners")} == {
            key: before[key] for key in ("packet listeners", "event listeners")
        }

    run_scenario(scenario)
