from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import SetpointError
from mavstack.services.setpoints import GlobalSetpoint, LocalSetpoint, SetpointStreamer
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import run_timers, sent_by

HERE, THERE = LocalSetpoint(position=(0, 0, -5)), LocalSetpoint(position=(9, 0, -5))


def test_the_newest_setpoint_is_repeated_at_the_rate():
    streamer = SetpointStreamer(GROUND, VEHICLE, rate=10.0)
    streamer.set(HERE, START)
    sent_by(streamer, START)
    assert [message.x for _, message in run_timers(streamer, START + 0.45)] == [0.0] * 4
    streamer.set(THERE, START + 0.45)
    assert sent_by(streamer, START + 0.45) == []  # a new one waits for its beat
    out = run_timers(streamer, START + 0.65)
    assert [message.x for _, message in out] == [9.0] * 2
    assert [message.time_boot_ms for _, message in out] == [500, 600]


def test_the_kind_may_change_while_streaming():
    streamer = SetpointStreamer(GROUND, VEHICLE)
    streamer.set(HERE, 0.0)
    streamer.set(GlobalSetpoint(1, 2, 3), 0.01)
    (message,) = sent_by(streamer, 0.02)
    assert isinstance(message, common.SetPositionTargetGlobalInt)
    assert (message.target_system, message.target_component) == VEHICLE


def test_an_impossible_setpoint_raises_at_once_and_changes_nothing():
    streamer = SetpointStreamer(GROUND, VEHICLE)
    streamer.set(HERE, 0.0)
    with pytest.raises(SetpointError):
        streamer.set(LocalSetpoint(), 0.1)
    assert streamer.setpoint == HERE


def test_stopped_it_sends_nothing_and_begins_again_with_the_next():
    streamer = SetpointStreamer(GROUND, VEHICLE, rate=10.0)
    streamer.start(0.0)
    assert sent_by(streamer, 0.0) == []  # there is nothing to send yet
    streamer.set(HERE, 0.0)
    streamer.stop(0.3)
    assert run_timers(streamer, 5.0) == []
    streamer.set(THERE, 6.0)
    assert [message.x for message in sent_by(streamer, 6.0)] == [9.0]
