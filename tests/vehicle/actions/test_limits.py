"""Far targets: refused before anything is sent, or explained when the vehicle refuses them."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import CommandDenied, InvalidArgumentError
from mavstack.vehicle.actions.limits import POSITION_CHECK_TIMEOUT
from tests.vehicle.failures.scripted_autopilot import CMD, ScriptedAutopilot, run_scenario
from tests.vehicle.firmware.received_requests import HERE, requests_of

FAR = (-33.9, -151.2)
NEAR = (HERE[0] + 0.001, HERE[1])
CALLS = [
    lambda vehicle, place: vehicle.goto(*place, 30, override_limits=True),
    lambda vehicle, place: vehicle.orbit(*place, 30, override_limits=True),
]


@pytest.mark.parametrize("call", CALLS, ids=["goto", "orbit"])
@pytest.mark.parametrize(
    ("place", "text", "ending"),
    [
        (FAR, None, r"DENIED \(the target is 19,\d\d\d km away\)$"),
        (FAR, "outside the fence", r"DENIED \(outside the fence\)$"),
        (NEAR, None, "DENIED$"),
    ],
    ids=["far", "far with a reason", "near"],
)
def test_a_refusal_without_a_reason_names_the_distance_of_a_far_target(call, place, text, ending):
    async def scenario(harness):
        harness.autopilot.arm()
        harness.autopilot.refuse(CMD.DO_REPOSITION, CMD.DO_ORBIT)
        if text is not None:
            harness.autopilot.on_refusal = lambda: harness.send_statustext(text)
        with pytest.raises(CommandDenied, match=ending):
            await call(harness.vehicle, place)

    run_scenario(scenario)


def hide_position(monkeypatch) -> list[bool]:
    """Let scripted autopilots send their position only once the returned list has an element."""
    visible: list[bool] = []
    position = ScriptedAutopilot._position
    monkeypatch.setattr(
        ScriptedAutopilot, "_position", lambda self, now: position(self, now) if visible else None
    )
    return visible


def test_the_distance_is_checked_when_the_first_position_has_arrived(monkeypatch):
    visible = hide_position(monkeypatch)

    async def scenario(harness):
        going = asyncio.create_task(harness.vehicle.goto(*FAR, 30))
        await asyncio.sleep(0.5)
        assert not going.done()
        visible.append(True)
        with pytest.raises(InvalidArgumentError, match=r"within 100 km .*, 19,\d\d\d km away"):
            await going
        assert requests_of(harness) == []

    run_scenario(scenario)


def test_a_vehicle_without_a_position_decides_itself(monkeypatch):
    hide_position(monkeypatch)

    async def scenario(harness):
        begun = harness.connection.now()
        await harness.vehicle.goto(*NEAR, 30, wait=False)
        assert harness.connection.now() - begun == pytest.approx(POSITION_CHECK_TIMEOUT, abs=0.5)
        assert requests_of(harness)[-1][1] == "DO_REPOSITION"

    run_scenario(scenario)
