"""The timer that ends operations whose target fell silent, and spares those whose target is there."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import CommandTimeout
from tests.vehicle.failures.scripted_autopilot import CMD, ScriptedHarness, run_scenario


async def fall_silent(harness: ScriptedHarness, seconds: float) -> None:
    harness.autopilot.silent = True
    await asyncio.sleep(seconds)


def test_a_call_after_a_long_silence_fails_after_the_grace_time():
    async def scenario(harness):
        await fall_silent(harness, 30.0)
        begun = harness.connection.now()
        with pytest.raises(CommandTimeout, match=r"it fell silent 3[0-9] s ago"):
            await harness.vehicle.command(CMD.DO_SET_SERVO, 1, 1500)
        assert 1.0 < harness.connection.now() - begun < 3.0

    run_scenario(scenario)


def test_a_vehicle_that_is_back_within_the_grace_time_is_reached():
    async def scenario(harness):
        await fall_silent(harness, 30.0)
        asyncio.get_running_loop().call_later(0.5, lambda: setattr(harness.autopilot, "silent", False))
        await harness.vehicle.set_mode("LOITER")

    run_scenario(scenario)


def test_a_timeout_of_the_program_outlasts_the_silence():
    async def scenario(harness):
        await fall_silent(harness, 30.0)
        asyncio.get_running_loop().call_later(4.0, lambda: setattr(harness.autopilot, "silent", False))
        await harness.vehicle.set_mode("LOITER", timeout=20.0)

    run_scenario(scenario)
