from __future__ import annotations

from itertools import pairwise
from random import Random

import pytest

from mavstack.dialects import common
from mavstack.services.events import EventReceived, EventReceiver, EventsLost
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import (
    deliver,
    packet_of,
    random_message,
    run_timers,
    sent_by,
)

RESET = common.MavEventCurrentSequenceFlags.RESET


def event(sequence: int, **fields) -> common.Event:
    return common.Event(id=sequence, sequence=sequence, log_levels=0x62, **fields)


def current(sequence: int, flags: int = 0) -> common.CurrentEventSequence:
    return common.CurrentEventSequence(sequence=sequence, flags=flags)


def gone(sequence: int, oldest: int) -> common.ResponseEventError:
    return common.ResponseEventError(
        target_system=GROUND.system,
        target_component=GROUND.component,
        sequence=sequence,
        sequence_oldest_available=oldest,
    )


class Received:
    """A receiver, and the numbers that it emitted; lost events are negative counts."""

    def __init__(self, *messages) -> None:
        self.receiver = EventReceiver(GROUND, VEHICLE)
        self.now = START
        self.deliver(*messages)

    def deliver(self, *messages) -> list[int]:
        for message in messages:
            deliver(self.receiver, message, VEHICLE, self.now)
        return self.take()

    def take(self) -> list[int]:
        return [
            -each.count if isinstance(each, EventsLost) else each.sequence for each in self.receiver.events()
        ]

    def requests(self) -> list[tuple[int, int]]:
        return [(each.first_sequence, each.last_sequence) for each in sent_by(self.receiver, self.now)]


def test_events_are_given_with_levels_and_arguments():
    received = Received()
    deliver(received.receiver, event(7, arguments=b"\x01", event_time_boot_ms=5), VEHICLE, START)
    (found,) = received.receiver.events()
    assert found == EventReceived(VEHICLE, 7, 7, 5, 2, 6, b"\x01".ljust(40, b"\0"))
    assert found.time == START


def test_duplicates_are_left_out_and_numbers_wrap():
    received = Received(current(65534))
    assert received.deliver(event(65535), event(65535), event(0), event(65535), event(1)) == [65535, 0, 1]
    assert received.requests() == []


def test_a_gap_is_requested_and_the_order_is_kept():
    received = Received(event(1))
    assert received.deliver(event(4)) == []
    assert received.requests() == [(2, 3)]
    assert received.deliver(event(3)) == []
    assert received.deliver(event(2)) == [2, 3, 4]
    assert received.receiver.next_timeout() is None


def test_a_lost_last_event_is_noticed_by_the_announcement():
    received = Received(event(1), current(3))
    assert received.requests() == [(2, 3)]
    assert received.deliver(event(2), event(3)) == [2, 3]


def test_events_from_before_the_start_are_not_requested():
    assert Received(current(500)).requests() == []
    assert Received(event(500)).requests() == []


def test_requests_are_repeated_less_and_less_often_and_end():
    received = Received(event(1), event(3))
    sent_by(received.receiver, START)
    times = [time - START for time, _ in run_timers(received.receiver, START + 60)]
    assert times[0] == pytest.approx(0.1)
    assert len(times) == 7
    assert all(later > 1.5 * earlier for earlier, later in pairwise(times))
    assert received.take() == [-1, 3]
    assert received.receiver.next_timeout() is None


def test_events_that_are_gone_are_reported_as_lost():
    received = Received(event(1), event(9))
    assert received.requests() == [(2, 8)]
    assert received.deliver(gone(2, 6)) == [-4]
    assert received.deliver(event(6), event(7), event(8)) == [6, 7, 8, 9]


def test_an_error_without_a_newer_number_loses_one_event():
    received = Received(event(1), event(4))
    assert received.deliver(gone(3, 3)) == []
    assert received.deliver(event(2)) == [2, -1, 4]


def test_errors_for_other_numbers_change_nothing():
    received = Received(event(1), event(3))
    assert received.deliver(gone(1, 2), gone(4, 9), gone(30000, 30002)) == []
    assert received.deliver(event(2)) == [2, 3]


def test_a_huge_gap_is_skipped_up_to_the_last_events():
    received = Received(event(1))
    assert received.deliver(event(20000)) == [-(20000 - 64 - 1)]
    assert received.requests() == [(20000 - 63, 19999)]
    assert len(received.receiver._waiting) == 1


def test_waiting_events_in_front_of_a_huge_gap_are_not_lost():
    received = Received(event(1), event(3))
    found = received.deliver(event(200))
    assert 3 in found
    assert -sum(count for count in found if count < 0) == 200 - 64 - 1 - 1


def test_a_reset_starts_anew():
    received = Received(event(60), event(62))
    received.now += 5.0
    received.deliver(current(10, RESET), current(10, RESET))
    assert received.deliver(event(11)) == [11]
    assert received.receiver.next_timeout() is None


def test_a_reset_with_the_number_of_the_first_event_does_not_lose_it():
    for events, expected in (((10, 10, 11, 11), [10, 11]), ((11, 11, 10), [11])):
        received = Received(event(60))
        received.now += 5.0
        assert received.deliver(current(10, RESET), *map(event, events)) == expected


def test_a_reboot_whose_reset_was_lost_is_noticed():
    received = Received(event(60), event(61))
    received.deliver(current(12))
    assert received.requests() == [], "one older number may be late"
    received.now += 3.0
    received.deliver(current(12))
    assert received.requests() == [(12, 12)]
    assert received.deliver(event(12), event(13)) == [12, 13]


def test_a_reboot_is_noticed_by_an_older_time_of_a_newer_event():
    received = Received(event(60, event_time_boot_ms=90_000))
    assert received.deliver(event(65, event_time_boot_ms=1_000)) == [65]
    assert received.requests() == []


def test_a_requested_event_is_older_than_those_behind_the_gap_without_a_reboot():
    received = Received(event(60, event_time_boot_ms=10_000), event(62, event_time_boot_ms=90_000))
    assert received.deliver(event(61, event_time_boot_ms=11_000)) == [61, 62]


def test_a_late_reset_repeats_no_event():
    received = Received(current(59, RESET), event(60), event(61))
    received.deliver(current(59, RESET), event(61))
    assert received.deliver(event(62)) == [62]
    received.now += 3.0
    assert received.deliver(current(59, RESET), event(60)) == [60], "the sender rebooted"


def test_a_late_announcement_is_no_reboot():
    received = Received(event(60), current(58))
    received.now += 3.0
    assert received.deliver(event(61), current(60)) == [61]
    assert received.requests() == []


def test_events_for_others_count_but_are_not_given():
    received = Received(event(1))
    other = event(2, destination_system=9, destination_component=1)
    ours = event(3, destination_system=GROUND.system, destination_component=0)
    assert received.deliver(other, ours) == [3]
    assert received.requests() == []


def test_random_payloads_do_no_harm():
    random, received = Random(1), Received()
    for _ in range(2000):
        kind = random.choice([common.Event, common.CurrentEventSequence, common.ResponseEventError])
        received.receiver.receive(packet_of(random_message(kind, random), VEHICLE), received.now)
        received.now += random.choice([0.0, 0.0, 3.0])
        received.receiver.handle_timeout(received.now)
        list(received.receiver.messages_to_send(received.now))
        received.receiver.events()
        assert len(received.receiver._waiting) <= 64
        assert len(received.receiver._gone) <= 64
