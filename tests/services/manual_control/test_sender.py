from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.services.manual_control import (
    ChannelOverride,
    ManualControlSender,
    ManualInput,
    OverrideSender,
)
from mavstack.services.manual_control.sender import RELEASE_COUNT
from tests.services.network import GROUND, VEHICLE
from tests.services.single_service import run_timers, sent_by


def messages(sender, until):
    return [message for _, message in run_timers(sender, until)]


def test_sticks_are_repeated_at_the_rate_with_the_newest_input():
    sender = ManualControlSender(GROUND, VEHICLE, rate=10.0)
    sender.set(ManualInput(x=1), 0.0)
    assert [m.x for m in [*sent_by(sender, 0.0), *messages(sender, 0.25)]] == [1, 1, 1]
    sender.set(ManualInput(x=2, buttons=3), 0.25)
    (message,) = messages(sender, 0.35)
    assert (message.target, message.x, message.buttons) == (1, 2, 3)


def test_stopping_lets_go_of_sticks_and_buttons_several_times_then_is_silent():
    sender = ManualControlSender(GROUND, VEHICLE, rate=50.0)
    sender.set(ManualInput(x=500, z=900, buttons=1), 0.0)
    sent_by(sender, 0.0)
    sender.stop(0.1)
    out = [*sent_by(sender, 0.1), *messages(sender, 60.0)]
    assert [(m.x, m.z, m.buttons) for m in out] == [(32767, 32767, 0)] * RELEASE_COUNT
    assert not sender.active
    assert sender.next_timeout() is None


def test_stopping_gives_overridden_channels_back_several_times():
    sender = OverrideSender(GROUND, VEHICLE, rate=50.0)
    sender.set(ChannelOverride({3: 1500, 12: 1900}), 0.0)
    (message,) = sent_by(sender, 0.0)
    assert (message.chan3_raw, message.chan12_raw, message.chan4_raw) == (1500, 1900, 65535)
    sender.stop(0.1)
    sender.stop(0.2)
    out = [*sent_by(sender, 0.2), *messages(sender, 60.0)]
    assert [(m.chan3_raw, m.chan12_raw, m.chan4_raw) for m in out] == [(0, 65534, 65535)] * RELEASE_COUNT
    assert not sender.active


def test_a_channel_that_is_no_longer_given_is_given_back():
    sender = OverrideSender(GROUND, VEHICLE, rate=10.0)
    sender.set(ChannelOverride({3: 1500, 4: 1600}), 0.0)
    sent_by(sender, 0.0)
    sender.set(ChannelOverride({4: 1700}), 0.05)
    (message,) = messages(sender, 0.15)
    assert (message.chan3_raw, message.chan4_raw) == (0, 1700)


def test_taking_hold_again_while_letting_go():
    sender = OverrideSender(GROUND, VEHICLE, rate=20.0)
    sender.set(ChannelOverride({3: 1500}), 0.0)
    sender.stop(0.1)
    sent_by(sender, 0.1)
    sender.set(ChannelOverride({3: 1400}), 0.2)
    out = [*sent_by(sender, 0.2), *messages(sender, 1.2)]
    assert {m.chan3_raw for m in out} == {1400}
    assert len(out) >= 20
    assert sender.active


def test_stopping_what_never_began_sends_nothing():
    sender = ManualControlSender(GROUND, VEHICLE)
    sender.stop(0.0)
    assert sent_by(sender, 0.0) == []
    assert sender.next_timeout() is None


def test_impossible_input_raises_and_changes_nothing():
    sender = OverrideSender(GROUND, VEHICLE)
    with pytest.raises(InvalidArgumentError):
        sender.set(ChannelOverride({99: 1500}), 0.0)
    assert not sender.active
