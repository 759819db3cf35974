from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services import Address, Priority
from mavstack.services.stream_sender import StreamSender, Ticker
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import run_timers, sent_by


class Counter(StreamSender):
    """Sends the time at which each message was made."""

    def current_message(self, now):
        return common.SystemTime(time_unix_usec=round(now * 1e6))


@pytest.mark.parametrize("rate", [0.3, 3.0, 7.0, 20.0, 33.3, 400.0])
@pytest.mark.parametrize("start", [0.0, 0.1, START, START + 1 / 3])
def test_the_rate_is_kept_without_drift(rate, start):
    sender = Counter(GROUND, VEHICLE, rate)
    sender.start(start)
    sent_by(sender, start)
    times = [time for time, _ in run_timers(sender, start + 100 / rate + 1e-4)]
    assert len(times) == 100
    assert times[-1] == pytest.approx(start + 100 / rate, abs=1e-6)


def test_a_stall_is_not_made_up_for():
    sender = Counter(GROUND, VEHICLE, 10.0)
    sender.start(0.0)
    assert len(sent_by(sender, 0.0)) == 1
    sender.handle_timeout(5.03)
    assert len(sent_by(sender, 5.03)) == 1
    assert sent_by(sender, 5.03) == []
    assert sender.next_timeout() == pytest.approx(5.1)


def test_what_finds_no_room_is_made_when_there_is_room_and_sent_once():
    sender = Counter(GROUND, VEHICLE, 10.0)
    asked = []

    def no_room(target: Address, priority: Priority = Priority.BULK) -> bool:
        asked.append((target, priority))
        return False

    sender.start(0.0)
    for now in (0.0, 0.1, 0.2):
        sender.handle_timeout(now)
        assert sent_by(sender, now, no_room) == []
    assert asked == [(VEHICLE, Priority.STREAM)] * 3
    (message,) = sent_by(sender, 0.25)
    assert message.time_unix_usec == 250_000
    assert sent_by(sender, 0.25) == []


def test_after_stop_nothing_is_sent_and_no_timer_runs():
    sender = Counter(GROUND, VEHICLE, 10.0)
    sender.start(0.0)
    sender.stop(0.05)
    assert sent_by(sender, 1.0) == []
    assert sender.next_timeout() is None
    assert not sender.active


@pytest.mark.parametrize("rate", [0.0, -1.0, 1001.0, float("nan"), float("inf")])
def test_impossible_rates_are_our_own_misuse(rate):
    with pytest.raises(InvalidArgumentError):
        Counter(GROUND, VEHICLE, rate)


def test_a_beat_is_never_due_twice():
    beats = Ticker(3.0, 1e9)
    now = 1e9
    for _ in range(1000):
        assert beats.passed(now)
        assert not beats.passed(now)
        assert beats.next > now
        now = beats.next
