"""Boot tracker: it distinguishes a reboot, two vehicles, and one vehicle over two links."""

from __future__ import annotations

from random import Random

import pytest

from mavstack.services.heartbeat.boot_tracker import CONFLICT_ENDS_AFTER, BootTracker, Finding

REBOOTED, CONFLICT, CONFLICT_ENDED = Finding.REBOOTED, Finding.CONFLICT, Finding.CONFLICT_ENDED
START = 1_700_000_000.0


def stream(booted, begin, end, *, every=0.25, delay=0.0, speed=1.0):
    """Messages of one sender: (arrival time, time since boot), both in seconds."""
    count = int((end - begin) / every)
    sent = [begin + number * every for number in range(count)]
    return [(at + delay, (at - booted) * speed) for at in sent]


def findings(*streams):
    """Findings other than NOTHING, with their times."""
    tracker = BootTracker()
    found = []
    for at, since_boot in sorted(message for each in streams for message in each):
        finding = tracker.observe(round(since_boot * 1000) % (1 << 32), START + at, "a link")
        if finding is not Finding.NOTHING:
            found.append((finding, at))
    return found


def kinds(*streams):
    return [finding for finding, _ in findings(*streams)]


def test_normal_flight_has_no_finding():
    assert kinds(stream(-100, 0, 600)) == []


def test_reboot_is_reported_at_once():
    ((finding, at),) = findings(stream(-100, 0, 50), stream(51.0, 52.5, 200))
    assert finding is REBOOTED
    assert at == 52.5


def test_each_of_several_reboots_is_reported():
    boots = [stream(-100, 0, 10), stream(11, 12, 18), stream(19, 20, 26), stream(27, 28, 60)]
    assert kinds(*boots) == [REBOOTED] * 3


def test_reboot_shortly_after_boot_is_reported():
    assert kinds(stream(0, 0.5, 2), stream(2.1, 3.2, 30)) == [REBOOTED]


def test_reboot_during_a_long_silence_is_reported():
    assert kinds(stream(-5, 0, 20), stream(100, 300, 320)) == [REBOOTED]


def test_silence_is_no_reboot():
    assert kinds(stream(-5, 0, 20), stream(-5, 500, 520)) == []


def test_reboot_without_silence_is_reported_when_the_old_boot_ends():
    ((finding, at),) = findings(stream(-100, 0, 50), stream(49.9, 50, 200))
    assert finding is REBOOTED
    assert 52 < at < 54


def test_delayed_messages_do_not_turn_a_reboot_into_a_conflict():
    quick = [*stream(-100, 0, 50), *stream(51, 52.5, 200)]
    slow = [*stream(-100, 0, 50, every=1.0, delay=6.0), *stream(51, 52.5, 200, every=1.0, delay=6.0)]
    assert kinds(quick, slow).count(CONFLICT) == 0
    assert REBOOTED in kinds(quick, slow)


def test_slightly_late_messages_do_not_turn_a_reboot_into_a_conflict():
    late = stream(-100, 0, 50, delay=2.5)
    assert kinds(late, [*stream(-100, 0, 50), *stream(50.5, 51.2, 200)]) == [REBOOTED]


def test_counter_wraps():
    wrapped = 4294967.296
    assert kinds(stream(-wrapped + 20, 0, 60)) == []


@pytest.mark.parametrize("speed", [0.2, 2.0, 10.0])
def test_simulator_clock_may_have_any_speed(speed):
    assert kinds(stream(-100, 0, 120, speed=speed)) == []


def test_paused_simulator_is_no_reboot():
    before = stream(-100, 0, 20)
    assert kinds(before, [(at + 300, since) for at, since in stream(-100, 20, 60)]) == []


def test_suspend_of_the_local_machine_is_no_reboot():
    assert kinds(stream(-100, 0, 20), stream(-900, 20, 60)) == []


def test_queued_messages_after_a_stall_are_no_reboot():
    queued = [(50.0 + at * 0.01, since) for at, since in stream(-8, 36, 50)]
    assert kinds(stream(-8, 0, 30), queued, stream(-8, 50.2, 90)) == []


@pytest.mark.parametrize("delay", [0.5, 2.0, 3.5, 6.0, 9.0])
def test_one_vehicle_over_two_links_with_different_delays(delay):
    one, other = stream(-100, 0, 120), stream(-100, 0, 120, every=0.4, delay=delay)
    assert kinds(one, other) == []
    cut = [message for message in one if not 40 < message[0] < 80]
    assert kinds(cut, other) == []  # only the fast link is cut for a while


@pytest.mark.parametrize(("one", "other"), [(-100, -400), (-400, -100), (-100, -115), (-100, 30)])
def test_two_vehicles_are_reported_once_and_not_as_reboots(one, other):
    begin = max(other + 2, 30)
    ((finding, at),) = findings(stream(one, 0, 200), stream(other, begin, 200, every=0.3))
    assert finding is CONFLICT
    assert at < begin + 13


def test_two_vehicles_with_low_message_rates_are_reported():
    assert kinds(stream(-100, 0, 200, every=1.0), stream(-300, 0.4, 200, every=1.0)) == [CONFLICT]


def test_reboot_during_a_conflict_is_not_reported():
    one, other = stream(-100, 0, 200), [*stream(-400, 0, 60), *stream(61, 63, 200)]
    assert kinds(one, other) == [CONFLICT]


def test_conflict_ends_when_one_vehicle_is_gone_and_may_return():
    one, other = stream(-100, 0, 300), [*stream(-400, 0, 60), *stream(-400, 200, 300)]
    found = findings(one, other)
    assert [finding for finding, _ in found] == [CONFLICT, CONFLICT_ENDED, CONFLICT]
    assert found[1][1] == pytest.approx(60 + CONFLICT_ENDS_AFTER, abs=1)


def test_either_vehicle_may_remain_after_a_conflict():
    assert kinds(stream(-100, 0, 60), stream(-400, 0, 120)) == [CONFLICT, CONFLICT_ENDED]


def test_reboots_are_reported_again_after_a_conflict():
    assert kinds(stream(-100, 0, 60), [*stream(-400, 0, 120), *stream(121, 122.5, 150)]) == [
        CONFLICT,
        CONFLICT_ENDED,
        REBOOTED,
    ]


@pytest.mark.parametrize("seed", range(20))
def test_loss_and_jitter_cause_no_finding(seed):
    random = Random(seed)
    sent = [message for message in stream(-50, 0, 300, every=0.1) if random.random() > 0.4]
    assert kinds([(at + random.uniform(0.05, 1.5), since) for at, since in sent]) == []


def over_a_bad_link(sent, random):
    return [(at + random.uniform(0.05, 0.6), since) for at, since in sent if random.random() > 0.3]


@pytest.mark.parametrize("seed", range(20))
def test_reboot_is_reported_once_over_a_bad_link(seed):
    random = Random(seed)
    sent = [*stream(-50, 0, 100), *stream(101, 103, 200)]
    assert kinds(over_a_bad_link(sent, random)) == [REBOOTED]


@pytest.mark.parametrize("seed", range(20))
def test_conflict_is_reported_once_over_a_bad_link(seed):
    random = Random(seed)
    sent = [*stream(-50, 0, 100), *stream(-200, 0.1, 100)]
    assert kinds(over_a_bad_link(sent, random)) == [CONFLICT]


def test_memory_is_bounded():
    tracker, random = BootTracker(), Random(1)
    for number in range(1000):
        tracker.observe(random.randrange(1 << 32), START + number * 0.01, f"channel {number}")
    assert len(tracker.boots) <= 4
    assert all(len(boot.channels) <= 8 for boot in tracker.boots)


def test_ended_boot_is_dropped():
    tracker = BootTracker()
    for at, since_boot in [*stream(-100, 0, 20), *stream(21, 22, 23), (23.0, 122.0), *stream(21, 23.25, 60)]:
        tracker.observe(round(since_boot * 1000), START + at)
        if at == 30:
            assert len(tracker.boots) == 2  # the late message might continue
    assert len(tracker.boots) == 1


def findings_with_left_out(*streams):
    """As `findings`, but messages that continue the only boot are only noted when another one comes."""
    tracker, found, last = BootTracker(), [], None
    for at, since_boot in sorted(message for each in streams for message in each):
        boot_ms = round(since_boot * 1000) % (1 << 32)
        if last is not None and abs((boot_ms - last[0]) / 1000 - (at - last[1])) < 1.0:
            last = boot_ms, at
            continue
        if last is not None:
            tracker.note_expected(last[0], START + last[1], "a link")
        finding = tracker.observe(boot_ms, START + at, "a link")
        last = (boot_ms, at) if len(tracker.boots) == 1 and not tracker.in_conflict else None
        if finding is not Finding.NOTHING:
            found.append((finding, at))
    return found


@pytest.mark.parametrize(
    "streams",
    [
        (stream(-100, 0, 60), stream(61, 62, 120)),
        (stream(-100, 0, 60), stream(60.2, 60.5, 61), stream(61.2, 61.4, 90)),
        (stream(-100, 0, 120), stream(-4000, 30.1, 120)),
        (stream(-4000, 0, 120), stream(20, 30.1, 90)),
        (stream(-100, 0, 40), stream(-100, 80, 120)),
        (stream(-100, 0, 60), stream(-100, 70, 90, speed=1.0001), stream(90, 92, 130)),
    ],
)
def test_messages_that_only_continue_a_boot_may_be_left_out(streams):
    assert findings_with_left_out(*streams) == findings(*streams)


def test_only_newer_messages_of_the_current_boot_are_noted():
    tracker = BootTracker()
    tracker.note_expected(5_000, START, "a link")
    assert tracker.boots == ()
    tracker.observe(10_000, START, "a link")
    (boot,) = tracker.boots
    tracker.note_expected(11_000, START + 1, "a link")
    assert (boot.since_boot, boot.seen_at) == (11, START + 1)
    tracker.note_expected(10_500, START + 0.5, "a link")
    tracker.note_expected(500_000, START + 2, "a link")
    assert (boot.since_boot, boot.seen_at) == (11, START + 1)
