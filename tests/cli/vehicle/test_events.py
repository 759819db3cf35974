"""`mav vehicle events`."""

from __future__ import annotations

import asyncio
import json

import pytest

from mavstack.dialects import common
from tests.cli.harness import COPTER, PX4_COPTER

ARM = common.MavCmd.COMPONENT_ARM_DISARM


async def arm_twice(remote) -> None:
    """Arm and disarm, as another ground station."""
    await asyncio.sleep(2.0)
    await remote.command(ARM, 1)
    await remote.command(ARM, 0)


@pytest.mark.flight
def test_events_are_printed_with_their_words(simulate, mav):
    simulate(PX4_COPTER).meanwhile = arm_twice
    result = mav("vehicle", "events", "--for", 10)
    assert (result.code, result.err) == (0, "")
    lines = [line.split(maxsplit=1)[1] for line in result.out.splitlines()]
    assert lines == [
        "info      Armed, reason: external command",
        "info      Disarmed, reason: external command",
    ]


@pytest.mark.flight
def test_events_as_json_by_severity(simulate, mav):
    simulate(PX4_COPTER).meanwhile = arm_twice
    assert mav("vehicle", "events", "--for", 6, "--severity", "warning").out == ""
    first = json.loads(mav("vehicle", "events", "--for", 6, "--json").out.splitlines()[0])
    assert (first["name"], first["severity"]) == ("px4::commander_armed_by", "info")
    assert first["arguments"] == {"reason": "command_external"}
    assert (first["system"], first["component"]) == (1, 1)


@pytest.mark.flight
def test_a_vehicle_without_events(simulate, mav):
    simulate(COPTER)
    result = mav("vehicle", "events", "--for", 10)
    assert (result.code, result.out) == (0, "")
    assert "it sends no events" in result.err
