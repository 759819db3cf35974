"""What is asked for singly, and when."""

from __future__ import annotations

from mavstack.services import RoundTrip
from mavstack.services.parameters.missing_entries import MAX_WINDOW, MIN_WINDOW, MissingEntries


def listing(total: int, *, round_trip: float = 0.05) -> MissingEntries:
    trips = RoundTrip(initial=1.0, minimum=0.02)
    trips.add_sample(round_trip)
    gaps = MissingEntries(trips, 0.0)
    gaps.total = total
    return gaps


def wanted(gaps: MissingEntries, now: float) -> list[int]:
    asked = []
    while (index := gaps.next_wanted()) is not None:
        gaps.ask(index, now)
        asked.append(index)
    return asked


def test_a_gap_is_asked_for_once_the_list_has_ended_and_not_before() -> None:
    """ArduPilot's list stands still while it answers single requests."""
    gaps = listing(10)
    for index in (0, 1, 3, 4, 5, 6, 7, 8):
        gaps.take(index, 0.01)
    assert wanted(gaps, 0.01) == []
    gaps.take(9, 0.01)
    assert wanted(gaps, 0.01) == [2]


def test_the_tail_is_asked_for_when_the_list_falls_quiet() -> None:
    gaps = listing(10)
    for index in range(7):
        gaps.take(index, 0.1 * index)
    gaps.handle_timeout(0.7)
    assert wanted(gaps, 0.7) == []  # its pauses are of 0.1 s
    due = gaps.next_timeout()
    assert due is not None
    assert 0.85 < due < 1.0
    gaps.handle_timeout(due)
    assert wanted(gaps, due) == [9, 8, 7]


def test_the_last_entry_ends_the_list_at_once() -> None:
    gaps = listing(5)
    for index in (0, 1, 4):
        gaps.take(index, 0.0)
    assert wanted(gaps, 0.0) == [2, 3]


def test_a_list_that_goes_on_is_listened_to_again() -> None:
    gaps = listing(100)
    for index in range(10):
        gaps.take(index, 0.001 * index)
    gaps.handle_timeout(0.5)
    asked = wanted(gaps, 0.5)
    assert asked == list(range(99, 91, -1))  # where the list, if it goes on, comes last
    for index in (10, 11, 12):
        gaps.take(index, 0.51)
    for index in asked:
        gaps.take(index, 0.52)
    assert wanted(gaps, 0.52) == []


def test_a_list_that_goes_on_after_a_loss_is_asked_for_what_it_lost() -> None:
    gaps = listing(100)
    for index in range(10):
        gaps.take(index, 0.001 * index)
    gaps.handle_timeout(0.5)
    asked = wanted(gaps, 0.5)
    gaps.take(30, 0.51)
    for index in asked:
        gaps.take(index, 0.52)
    assert wanted(gaps, 0.52) == []
    due = gaps.next_timeout()
    assert due is not None
    gaps.handle_timeout(due)
    assert wanted(gaps, due) == list(range(10, 26))


def test_the_list_ends_where_it_meets_what_was_asked_for() -> None:
    gaps = listing(20)
    for index in range(6):
        gaps.take(index, 0.001 * index)
    gaps.handle_timeout(0.5)
    asked = wanted(gaps, 0.5)
    assert asked == list(range(19, 11, -1))
    for index in (6, 7, 8, 10):  # 9 is lost
        gaps.take(index, 0.51)
    assert wanted(gaps, 0.51) == []  # 9 may still come
    gaps.take(11, 0.51)
    for index in asked:
        gaps.take(index, 0.52)
    assert wanted(gaps, 0.52) == [9]


def test_a_total_that_changes_in_a_silence_leaves_nothing_out() -> None:
    gaps = listing(10)
    gaps.take(0, 0.0)
    gaps.handle_timeout(9.0)
    assert wanted(gaps, 9.0) == list(range(9, 1, -1))
    gaps.total = 12
    for index in range(9, 1, -1):
        gaps.take(index, 9.1)
    assert wanted(gaps, 9.1) == [11, 10, 1]


def test_a_single_value_from_afar_is_not_taken_for_the_list() -> None:
    gaps = listing(100)
    gaps.take(0, 0.0)
    gaps.take(90, 0.0)
    gaps.take(1, 0.0)
    assert wanted(gaps, 0.0) == []


def test_a_long_leap_is_believed_when_it_is_confirmed() -> None:
    gaps = listing(100)
    for index in (0, 60, 61):
        gaps.take(index, 0.0)
    gaps.handle_timeout(9.0)
    assert wanted(gaps, 9.0) == list(range(1, 9))


def test_the_window_grows_with_answers_and_shrinks_with_silence() -> None:
    gaps = listing(200)
    for index in (0, 30, 60, 90, 120, 150, 199, 199):
        gaps.take(index, 0.0)
    gaps.handle_timeout(10.0)
    now = 10.0
    for _ in range(5):
        for index in wanted(gaps, now):
            gaps.take(index, now + 0.04)
        now += 0.05
    assert gaps.window == MAX_WINDOW
    assert len(wanted(gaps, now)) == MAX_WINDOW
    for _ in range(20):
        now = gaps.next_timeout() or now
        gaps.handle_timeout(now)
        wanted(gaps, now)
    assert gaps.window == MIN_WINDOW


def test_what_stays_out_is_asked_for_again_until_it_comes() -> None:
    gaps = listing(3)
    gaps.take(0, 0.0)
    gaps.take(2, 0.0)
    assert wanted(gaps, 0.0) == [1]
    for _ in range(5):
        now = gaps.next_timeout()
        assert now is not None
        gaps.handle_timeout(now)
        assert wanted(gaps, now) == [1]
    assert gaps.take(1, now)
    assert gaps.complete
    assert gaps.next_timeout() is None
    assert wanted(gaps, now + 9) == []


def test_a_second_answer_shows_that_the_waiting_was_too_short() -> None:
    gaps = listing(3, round_trip=0.01)
    gaps.take(0, 0.0)
    gaps.take(2, 0.0)
    wanted(gaps, 0.0)
    gaps.handle_timeout(0.2)
    wanted(gaps, 0.2)
    gaps.take(1, 0.4)
    before = gaps._round_trip.timeout()
    gaps.take(1, 0.6)
    assert gaps._round_trip.timeout() > before


def test_indexes_out_of_range_are_nothing() -> None:
    gaps = listing(3)
    assert not gaps.take(3, 0.0)
    assert not gaps.take(-1, 0.0)
