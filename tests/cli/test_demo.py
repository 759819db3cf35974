from __future__ import annotations

import json
from itertools import pairwise

import pytest

from mavstack.cli.scripted_vehicle import (
    ARM,
    CIRCLE,
    DISARM,
    END,
    HEIGHT,
    LAND,
    TAKEOFF,
    ScriptedVehicle,
    state_at,
)
from mavstack.dialects import ardupilotmega, common


def flown(speed: float, seconds: float) -> list:
    vehicle = ScriptedVehicle(speed)
    return [message for tick in range(round(seconds * 100)) for message in vehicle.due(100 + tick / 100)]


def test_the_summary_tells_of_a_whole_flight(mav):
    result = mav("demo", "--for", "0.5", "--json")
    assert (result.code, result.err) == (0, "")
    summary = json.loads(result.out)
    assert summary["sources"] == ["1/1"]
    assert summary["lost"] == summary["bad_bytes"] == 0
    assert {"HEARTBEAT", "ATTITUDE", "GLOBAL_POSITION_INT", "STATUSTEXT", "BATTERY_STATUS"} <= set(
        summary["messages"]
    )


def test_without_a_terminal_it_ends_by_itself_with_a_page(mav):
    result = mav("demo", "--for", "0.3")
    assert result.code == 0
    assert "quadrotor" in result.out


def test_options_that_contradict_each_other(mav):
    assert mav("demo", "--out", "udpout://127.0.0.1:9", "--json").code == 2


def test_sending_only(mav):
    assert mav("demo", "--out", "udpout://127.0.0.1:9", "--for", "0.05").code == 0


def test_messages_come_at_their_rates():
    messages = flown(1, 10)
    count = sum(isinstance(message, common.Attitude) for message in messages)
    assert 199 <= count <= 201
    assert 10 <= sum(isinstance(message, common.Heartbeat) for message in messages) <= 14


@pytest.mark.parametrize("speed", [1, 20])
def test_the_script_is_told_in_order(speed):
    texts = [message.text for message in flown(speed, END / speed) if isinstance(message, common.Statustext)]
    assert texts == [
        "Mavstack scripted vehicle ready",
        "Arming motors",
        "Taking off",
        "Flying a circle",
        "Landing",
        "Disarming motors",
    ]


def test_it_begins_again():
    texts = [message.text for message in flown(50, 3 * END / 50) if isinstance(message, common.Statustext)]
    assert texts.count("Arming motors") == 3


@pytest.mark.parametrize("edge", [ARM, TAKEOFF, CIRCLE, LAND, DISARM])
def test_the_vehicle_does_not_jump(edge):
    before, after = state_at(edge - 1e-6), state_at(edge + 1e-6)
    assert before.north == pytest.approx(after.north, abs=1e-3)
    assert before.east == pytest.approx(after.east, abs=1e-3)
    assert before.height == pytest.approx(after.height, abs=1e-3)


def test_it_moves_as_fast_as_it_says():
    states = [state_at(20 + index / 10) for index in range(400)]
    for one, two in pairwise(states):
        way = ((two.north - one.north) ** 2 + (two.east - one.east) ** 2) ** 0.5
        assert way * 10 == pytest.approx(one.speed, rel=0.01)


def test_arming_mode_and_height():
    assert not state_at(ARM - 1).armed
    assert state_at(30).armed
    assert state_at(30).height == HEIGHT
    assert state_at(30).mode is ardupilotmega.CopterMode.CIRCLE
    assert state_at(END - 1).height == 0
    assert not state_at(END - 1).armed
