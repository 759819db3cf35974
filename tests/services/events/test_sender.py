from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services import Address
from mavstack.services.events import EventSender, LogLevel
from tests.services.single_service import deliver, run_timers, sent_by

VEHICLE, GROUND = Address(1, 1), Address(255, 190)
START = 1000.0


def request(first: int, last: int) -> common.RequestEvent:
    return common.RequestEvent(target_system=1, target_component=1, first_sequence=first, last_sequence=last)


def sender_with(count: int, **options) -> EventSender:
    sender = EventSender(VEHICLE, START, **options)
    for number in range(count):
        sender.report(number, START + 1)
    sent_by(sender, START + 1)
    return sender


def test_an_event_is_broadcast_with_number_time_levels_and_arguments():
    sender = EventSender(VEHICLE, START)
    sequence = sender.report(
        0x01ABCDEF,
        START + 2.5,
        arguments=b"\x04",
        level=LogLevel.CRITICAL,
        internal_level=LogLevel.INFO,
    )
    event = next(each for each in sent_by(sender, START + 2.5) if isinstance(each, common.Event))
    assert (event.id, event.sequence, event.event_time_boot_ms) == (0x01ABCDEF, sequence, 2500)
    assert (event.log_levels, bytes(event.arguments)[:2]) == (0x62, b"\x04\0")
    assert (event.destination_system, event.destination_component) == (0, 0)


def test_numbers_wrap():
    sender = EventSender(VEHICLE, START)
    numbers = [sender.report(1, START) for _ in range(12)]
    assert numbers[-2:] == [0, 1]
    assert numbers[0] == 65526


def test_the_newest_number_is_announced_every_three_seconds_with_reset_until_the_first_event():
    sender = EventSender(VEHICLE, START)
    flags = common.MavEventCurrentSequenceFlags
    assert sent_by(sender, START) == [common.CurrentEventSequence(sequence=sender.latest, flags=flags.RESET)]
    sender.report(1, START + 1)
    sent_by(sender, START + 1)
    announced = run_timers(sender, START + 6)
    assert [(time - START, message.sequence, message.flags) for time, message in announced] == [
        (3.0, sender.latest, 0),
        (6.0, sender.latest, 0),
    ]


def test_a_request_is_answered_by_number_over_the_wrap():
    sender = sender_with(12)
    deliver(sender, request(65535, 1), GROUND, START + 2)
    answers = list(sender.messages_to_send(START + 2))
    assert [answer.message.sequence for answer in answers] == [65535, 0, 1]
    assert {answer.target for answer in answers} == {GROUND}


def test_an_event_that_is_gone_is_answered_with_the_oldest_available():
    sender = sender_with(8, capacity=3)
    oldest = sender.latest - 2
    deliver(sender, request(oldest - 1, oldest), GROUND, START + 2)
    error, event = sent_by(sender, START + 2)
    assert error == common.ResponseEventError(
        target_system=255,
        target_component=190,
        sequence=oldest - 1,
        sequence_oldest_available=oldest,
        reason=common.MavEventErrorReason.UNAVAILABLE,
    )
    assert event.sequence == oldest


def test_the_largest_request_costs_one_error_and_the_events_kept():
    sender = sender_with(8, capacity=5)
    deliver(sender, request(sender.latest + 1, sender.latest), GROUND, START + 2)
    answers = sent_by(sender, START + 2)
    assert [type(answer) for answer in answers] == [common.ResponseEventError] + [common.Event] * 5


def test_answers_wait_for_room_and_are_bounded():
    sender = sender_with(5, capacity=5)
    for _ in range(100):
        deliver(sender, request(sender.latest - 4, sender.latest), GROUND, START + 2)
    assert sent_by(sender, START + 2, lambda *_: False) == []
    assert len(sent_by(sender, START + 2)) == 20


def test_too_many_arguments_are_refused():
    with pytest.raises(InvalidArgumentError, match="40 bytes"):
        EventSender(VEHICLE, START).report(1, START, arguments=bytes(41))
