"""Missing entries: which are requested individually, and when."""

from __future__ import annotations

from mavstack.services import RoundTrip
from mavstack.services.parameters.missing_entries import MAX_WINDOW, MIN_WINDOW, MissingEntries


def listing(total: int, *, round_trip: float = 0.05) -> MissingEntries:
    trips = RoundTrip(initial=1.0, minimum=0.02)
    trips.add_sample(round_trip)
    missing = MissingEntries(trips, 0.0)
    missing.total = total
    return missing


def wanted(missing: MissingEntries, now: float) -> list[int]:
    asked = []
    while (index := missing.next_wanted()) is not None:
        missing.request(index, now)
        asked.append(index)
    return asked


def test_a_missing_entry_is_requested_once_the_list_has_ended_and_not_before() -> None:
    """ArduPilot's list stands still while it answers single requests."""
    missing = listing(10)
    for index in (0, 1, 3, 4, 5, 6, 7, 8):
        missing.receive(index, 0.01)
    assert wanted(missing, 0.01) == []
    missing.receive(9, 0.01)
    assert wanted(missing, 0.01) == [2]


def test_the_tail_is_requested_when_the_list_falls_quiet() -> None:
    missing = listing(10)
    for index in range(7):
        missing.receive(index, 0.1 * index)
    missing.handle_timeout(0.7)
    assert wanted(missing, 0.7) == []  # its pauses are of 0.1 s
    due = missing.next_timeout()
    assert due is not None
    assert 0.85 < due < 1.0
    missing.handle_timeout(due)
    assert wanted(missing, due) == [9, 8, 7]


def test_the_last_entry_ends_the_list_at_once() -> None:
    missing = listing(5)
    for index in (0, 1, 4):
        missing.receive(index, 0.0)
    assert wanted(missing, 0.0) == [2, 3]


def test_a_list_that_continues_is_received_again() -> None:
    missing = listing(100)
    for index in range(10):
        missing.receive(index, 0.001 * index)
    missing.handle_timeout(0.5)
    asked = wanted(missing, 0.5)
    assert asked == list(range(99, 91, -1))  # where the list, if it goes on, comes last
    for index in (10, 11, 12):
        missing.receive(index, 0.51)
    for index in asked:
        missing.receive(index, 0.52)
    assert wanted(missing, 0.52) == []


def test_lost_entries_are_requested_after_a_list_that_continues() -> None:
    missing = listing(100)
    for index in range(10):
        missing.receive(index, 0.001 * index)
    missing.handle_timeout(0.5)
    asked = wanted(missing, 0.5)
    missing.receive(30, 0.51)
    for index in asked:
        missing.receive(index, 0.52)
    assert wanted(missing, 0.52) == []
    due = missing.next_timeout()
    assert due is not None
    missing.handle_timeout(due)
    assert wanted(missing, due) == list(range(10, 26))


def test_the_list_ends_where_it_meets_what_was_requested() -> None:
    missing = listing(20)
    for index in range(6):
        missing.receive(index, 0.001 * index)
    missing.handle_timeout(0.5)
    asked = wanted(missing, 0.5)
    assert asked == list(range(19, 11, -1))
    for index in (6, 7, 8, 10):  # 9 is lost
        missing.receive(index, 0.51)
    assert wanted(missing, 0.51) == []  # 9 may still come
    missing.receive(11, 0.51)
    for index in asked:
        missing.receive(index, 0.52)
    assert wanted(missing, 0.52) == [9]


def test_a_total_that_changes_in_a_silence_leaves_nothing_out() -> None:
    missing = listing(10)
    missing.receive(0, 0.0)
    missing.handle_timeout(9.0)
    assert wanted(missing, 9.0) == list(range(9, 1, -1))
    missing.total = 12
    for index in range(9, 1, -1):
        missing.receive(index, 9.1)
    assert wanted(missing, 9.1) == [11, 10, 1]


def test_a_single_value_from_afar_is_not_taken_for_the_list() -> None:
    missing = listing(100)
    missing.receive(0, 0.0)
    missing.receive(90, 0.0)
    missing.receive(1, 0.0)
    assert wanted(missing, 0.0) == []


def test_a_long_leap_is_believed_when_it_is_confirmed() -> None:
    missing = listing(100)
    for index in (0, 60, 61):
        missing.receive(index, 0.0)
    missing.handle_timeout(9.0)
    assert wanted(missing, 9.0) == list(range(1, 9))


def test_the_window_grows_with_answers_and_shrinks_with_silence() -> None:
    missing = listing(200)
    for index in (0, 30, 60, 90, 120, 150, 199, 199):
        missing.receive(index, 0.0)
    missing.handle_timeout(10.0)
    now = 10.0
    for _ in range(5):
        for index in wanted(missing, now):
            missing.receive(index, now + 0.04)
        now += 0.05
    assert missing.window == MAX_WINDOW
    assert len(wanted(missing, now)) == MAX_WINDOW
    for _ in range(20):
        now = missing.next_timeout() or now
        missing.handle_timeout(now)
        wanted(missing, now)
    assert missing.window == MIN_WINDOW


def test_what_stays_out_is_requested_again_until_it_comes() -> None:
    missing = listing(3)
    missing.receive(0, 0.0)
    missing.receive(2, 0.0)
    assert wanted(missing, 0.0) == [1]
    for _ in range(5):
        now = missing.next_timeout()
        assert now is not None
        missing.handle_timeout(now)
        assert wanted(missing, now) == [1]
    assert missing.receive(1, now)
    assert missing.complete
    assert missing.next_timeout() is None
    assert wanted(missing, now + 9) == []


def test_a_second_answer_shows_that_the_waiting_was_too_short() -> None:
    missing = listing(3, round_trip=0.01)
    missing.receive(0, 0.0)
    missing.receive(2, 0.0)
    wanted(missing, 0.0)
    missing.handle_timeout(0.2)
    wanted(missing, 0.2)
    missing.receive(1, 0.4)
    before = missing._round_trip.timeout()
    missing.receive(1, 0.6)
    assert missing._round_trip.timeout() > before


def test_indexes_out_of_range_are_nothing() -> None:
    missing = listing(3)
    assert not missing.receive(3, 0.0)
    assert not missing.receive(-1, 0.0)
