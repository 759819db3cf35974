"""A reboot, two vehicles, one vehicle over two links: told apart by the time since boot."""

from __future__ import annotations

from random import Random

import pytest

from mavstack.services.heartbeat.lives import OVER, Lives, Verdict

REBOOTED, CLASH, CLASH_OVER = Verdict.REBOOTED, Verdict.CLASH, Verdict.CLASH_OVER
START = 1_700_000_000.0


def stream(booted, begin, end, *, every=0.25, delay=0.0, speed=1.0):
    """What comes of one sender: (when it comes, the time since boot that it tells)."""
    count = int((end - begin) / every)
    sent = [begin + number * every for number in range(count)]
    return [(at + delay, (at - booted) * speed) for at in sent]


def told(*streams):
    """The verdicts but NOTHING, with when they fell."""
    lives = Lives()
    verdicts = []
    for at, since_boot in sorted(message for each in streams for message in each):
        verdict = lives.observe(round(since_boot * 1000) % (1 << 32), START + at, "a link")
        if verdict is not Verdict.NOTHING:
            verdicts.append((verdict, at))
    return verdicts


def kinds(*streams):
    return [verdict for verdict, _ in told(*streams)]


def test_nothing_is_told_of_a_usual_flight():
    assert kinds(stream(-100, 0, 600)) == []


def test_a_reboot_is_told_at_once():
    ((verdict, at),) = told(stream(-100, 0, 50), stream(51.0, 52.5, 200))
    assert verdict is REBOOTED
    assert at == 52.5


def test_every_reboot_is_told_however_soon():
    lives = [stream(-100, 0, 10), stream(11, 12, 18), stream(19, 20, 26), stream(27, 28, 60)]
    assert kinds(*lives) == [REBOOTED] * 3


def test_a_reboot_right_after_the_start_is_told():
    assert kinds(stream(0, 0.5, 2), stream(2.1, 3.2, 30)) == [REBOOTED]


def test_a_reboot_in_a_long_silence_is_told_though_the_vehicle_is_up_for_longer_than_before():
    assert kinds(stream(-5, 0, 20), stream(100, 300, 320)) == [REBOOTED]


def test_a_silence_is_no_reboot():
    assert kinds(stream(-5, 0, 20), stream(-5, 500, 520)) == []


def test_a_reboot_without_a_silence_is_told_when_the_old_life_is_over():
    ((verdict, at),) = told(stream(-100, 0, 50), stream(49.9, 50, 200))
    assert verdict is REBOOTED
    assert 52 < at < 54


def test_what_was_still_on_its_way_does_not_make_a_reboot_a_clash():
    quick = [*stream(-100, 0, 50), *stream(51, 52.5, 200)]
    slow = [*stream(-100, 0, 50, every=1.0, delay=6.0), *stream(51, 52.5, 200, every=1.0, delay=6.0)]
    assert kinds(quick, slow).count(CLASH) == 0
    assert REBOOTED in kinds(quick, slow)


def test_what_was_a_little_late_does_not_make_a_reboot_a_clash():
    late = stream(-100, 0, 50, delay=2.5)
    assert kinds(late, [*stream(-100, 0, 50), *stream(50.5, 51.2, 200)]) == [REBOOTED]


def test_the_counter_wraps():
    wrapped = 4294967.296
    assert kinds(stream(-wrapped + 20, 0, 60)) == []


@pytest.mark.parametrize("speed", [0.2, 2.0, 10.0])
def test_a_simulators_clock_may_run_as_it_likes(speed):
    assert kinds(stream(-100, 0, 120, speed=speed)) == []


def test_a_halted_simulator_goes_on():
    before = stream(-100, 0, 20)
    assert kinds(before, [(at + 300, since) for at, since in stream(-100, 20, 60)]) == []


def test_our_own_machine_may_sleep():
    assert kinds(stream(-100, 0, 20), stream(-900, 20, 60)) == []


def test_a_stall_that_comes_late_out_of_a_queue_is_no_reboot():
    queued = [(50.0 + at * 0.01, since) for at, since in stream(-8, 36, 50)]
    assert kinds(stream(-8, 0, 30), queued, stream(-8, 50.2, 90)) == []


@pytest.mark.parametrize("delay", [0.5, 2.0, 3.5, 6.0, 9.0])
def test_one_vehicle_over_two_links_of_different_delay_is_one(delay):
    one, other = stream(-100, 0, 120), stream(-100, 0, 120, every=0.4, delay=delay)
    assert kinds(one, other) == []
    cut = [message for message in one if not 40 < message[0] < 80]
    assert kinds(cut, other) == []  # the quick one alone is cut for a while


@pytest.mark.parametrize(("one", "other"), [(-100, -400), (-400, -100), (-100, -115), (-100, 30)])
def test_two_vehicles_are_told_once_and_never_as_reboots(one, other):
    begin = max(other + 2, 30)
    ((verdict, at),) = told(stream(one, 0, 200), stream(other, begin, 200, every=0.3))
    assert verdict is CLASH
    assert at < begin + 13


def test_two_vehicles_that_are_heard_rarely_are_told_too():
    assert kinds(stream(-100, 0, 200, every=1.0), stream(-300, 0.4, 200, every=1.0)) == [CLASH]


def test_a_reboot_amid_a_clash_is_not_told():
    one, other = stream(-100, 0, 200), [*stream(-400, 0, 60), *stream(61, 63, 200)]
    assert kinds(one, other) == [CLASH]


def test_a_clash_is_over_when_one_is_gone_and_may_come_again():
    one, other = stream(-100, 0, 300), [*stream(-400, 0, 60), *stream(-400, 200, 300)]
    verdicts = told(one, other)
    assert [verdict for verdict, _ in verdicts] == [CLASH, CLASH_OVER, CLASH]
    assert verdicts[1][1] == pytest.approx(60 + OVER, abs=1)


def test_the_other_one_may_be_who_stays():
    assert kinds(stream(-100, 0, 60), stream(-400, 0, 120)) == [CLASH, CLASH_OVER]


def test_after_a_clash_reboots_are_told_again():
    assert kinds(stream(-100, 0, 60), [*stream(-400, 0, 120), *stream(121, 122.5, 150)]) == [
        CLASH,
        CLASH_OVER,
        REBOOTED,
    ]


@pytest.mark.parametrize("seed", range(20))
def test_loss_and_jitter_make_neither_a_reboot_nor_a_clash(seed):
    random = Random(seed)
    sent = [message for message in stream(-50, 0, 300, every=0.1) if random.random() > 0.4]
    assert kinds([(at + random.uniform(0.05, 1.5), since) for at, since in sent]) == []


def over_a_bad_link(sent, random):
    return [(at + random.uniform(0.05, 0.6), since) for at, since in sent if random.random() > 0.3]


@pytest.mark.parametrize("seed", range(20))
def test_a_reboot_is_told_once_over_a_bad_link(seed):
    random = Random(seed)
    sent = [*stream(-50, 0, 100), *stream(101, 103, 200)]
    assert kinds(over_a_bad_link(sent, random)) == [REBOOTED]


@pytest.mark.parametrize("seed", range(20))
def test_a_clash_is_told_once_over_a_bad_link(seed):
    random = Random(seed)
    sent = [*stream(-50, 0, 100), *stream(-200, 0.1, 100)]
    assert kinds(over_a_bad_link(sent, random)) == [CLASH]


def test_memory_is_bounded():
    lives, random = Lives(), Random(1)
    for number in range(1000):
        lives.observe(random.randrange(1 << 32), START + number * 0.01, f"channel {number}")
    assert len(lives.all) <= 4
    assert all(len(life.channels) <= 8 for life in lives.all)


def test_a_life_that_is_over_is_forgotten():
    lives = Lives()
    for at, since_boot in [*stream(-100, 0, 20), *stream(21, 22, 23), (23.0, 122.0), *stream(21, 23.25, 60)]:
        lives.observe(round(since_boot * 1000), START + at)
        if at == 30:
            assert len(lives.all) == 2  # what came late might yet go on
    assert len(lives.all) == 1
