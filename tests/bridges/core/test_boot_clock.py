"""The wall clock of vehicles."""

from __future__ import annotations

from random import Random

from mavstack.bridges.core.boot_clock import MAX_AGE, BootClock

BOOTED = 1_700_000_000_000_000_000
MILLISECOND = 1_000_000


def test_timesync_gives_the_time() -> None:
    clock = BootClock()
    clock.timesync_offset = -BOOTED
    arrival = BOOTED + 5_030 * MILLISECOND
    assert clock.from_boot(5_000 * MILLISECOND, arrival) == BOOTED + 5_000 * MILLISECOND


def test_a_time_is_never_later_than_the_arrival() -> None:
    clock = BootClock()
    clock.timesync_offset = -BOOTED - 20 * MILLISECOND
    arrival = BOOTED + 5_000 * MILLISECOND
    assert clock.from_boot(5_000 * MILLISECOND, arrival) == arrival


def test_without_timesync_the_shortest_delay_counts() -> None:
    clock, rng = BootClock(), Random(1)
    errors = []
    for number in range(1, 500):
        sent = BOOTED + number * 20 * MILLISECOND
        arrival = sent + 3 * MILLISECOND + int(rng.expovariate(1 / 20) * MILLISECOND)
        errors.append(clock.from_boot(number * 20 * MILLISECOND, arrival) - sent)
    assert all(0 <= error < 6 * MILLISECOND for error in errors[50:])


def test_a_reboot_starts_again() -> None:
    clock = BootClock()
    clock.from_boot(100_000 * MILLISECOND, BOOTED + 100_000 * MILLISECOND)
    arrival = BOOTED + 200_000 * MILLISECOND
    assert clock.from_boot(1_000 * MILLISECOND, arrival) == arrival


def test_unix_time_and_missing_time() -> None:
    clock = BootClock()
    arrival = BOOTED + 5 * MILLISECOND
    assert clock.from_microseconds(BOOTED // 1000, arrival) == BOOTED
    assert clock.from_microseconds(BOOTED // 1000, BOOTED + 2 * MAX_AGE) == BOOTED + 2 * MAX_AGE
    assert clock.from_microseconds(0, arrival) == arrival
