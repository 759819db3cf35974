from __future__ import annotations

import pytest

from mavstack.services.system_time import RebootDetector
from tests.services.network import START


def observe(*times: tuple[float, float]) -> list[bool]:
    """Return for each (seconds since boot, elapsed seconds) whether it shows a reboot."""
    detector = RebootDetector()
    return [detector.observe(round(boot * 1000), START + passed) for boot, passed in times]


def test_a_falling_time_means_a_reboot() -> None:
    assert observe((100, 0), (101, 1), (0.5, 4), (1.5, 5)) == [False, False, True, False]


def test_one_reboot_is_reported_once() -> None:
    detector = RebootDetector()
    for boot, passed in ((100, 0), (0.5, 4), (1.5, 5), (2.5, 6)):
        detector.observe(boot * 1000, START + passed)
    assert detector.reboots == 1
    assert detector.booted_at == START + 3.5


def test_reordered_messages_are_no_reboot() -> None:
    assert not any(observe((100, 0), (99.5, 0.01), (100.5, 0.5), (98, 0.6)))


def test_soon_after_its_start_and_again_after_a_while() -> None:
    assert observe((2.0, 0), (1.5, 60)) == [False, True]


def test_a_message_from_before_the_reboot_that_comes_late_is_no_second_one() -> None:
    assert observe((100, 0), (0.5, 4), (101, 4.5), (1.5, 5), (2.5, 6)) == [False, True, False, False, False]


def test_the_wrap_after_49_days_is_no_reboot() -> None:
    assert not any(observe((4294967.0, 0), (0.7, 1), (1.7, 2)))


def test_a_reboot_after_49_days_is_one() -> None:
    assert observe((4294900.0, 0), (0.7, 5))[-1]


def test_a_simulation_faster_or_slower_than_time_is_no_reboot() -> None:
    for speed in (0.1, 10.0):
        assert not any(observe(*((second * speed, second) for second in range(200))))


def test_a_pause_is_no_reboot() -> None:
    assert not any(observe((100, 0), (101, 600)))


def test_nothing_is_known_at_first() -> None:
    assert RebootDetector().booted_at is None


@pytest.mark.parametrize("period", [0.1, 1.0])
def test_every_reboot_of_many(period: float) -> None:
    detector, now, boot, seen = RebootDetector(), START, 0.0, 0
    for step in range(1000):
        boot = 0.0 if step % 100 == 99 else boot + period
        now += period
        seen += detector.observe(round(boot * 1000), now)
    assert seen == 10
