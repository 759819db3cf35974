"""The backlog of datagrams: fair to senders, and control messages survive a flood."""

from __future__ import annotations

from mavstack import Encoder
from mavstack.dialects import common
from mavstack.links.backlog import MAX_RARE, Backlog, first_message_id

ATTACKER, VEHICLE = ("10.0.0.9", 1), ("10.0.0.1", 14550)
TELEMETRY = Encoder(1, 1).encode(common.Attitude())
CONTROL = Encoder(1, 1).encode(common.CommandAck())


def senders(backlog):
    return [backlog.pop()[1] for _ in range(len(backlog))]


def test_the_message_id_is_that_of_the_first_packet():
    assert first_message_id(TELEMETRY) == 30
    assert first_message_id(Encoder(1, 1, version=1).encode(common.CommandAck())) == 77
    assert {first_message_id(data) for data in (b"", b"\xfd\x09", b"\xfe", bytes(20))} == {-1}


def test_senders_are_served_in_turn_and_keep_their_order():
    backlog = Backlog()
    for number in range(3):
        backlog.add((b"%d" % number, ATTACKER, 0.0), known=False)
    backlog.add((b"v", VEHICLE, 0.0), known=False)
    assert [backlog.pop()[0] for _ in range(4)] == [b"0", b"v", b"1", b"2"]
    assert not backlog


def test_a_flood_from_one_sender_loses_no_packet_of_another():
    backlog = Backlog(100)
    accepted = 0
    for number in range(10_000):
        backlog.add((TELEMETRY, ATTACKER, 0.0), known=False)
        if number % 1000 == 999:
            accepted += backlog.add((TELEMETRY, VEHICLE, 0.0), known=True)
    assert accepted == 10
    assert VEHICLE in senders(backlog)[:3]


def test_a_flood_of_telemetry_loses_no_control_message_of_its_sender():
    backlog = Backlog(100)
    for _ in range(1000):
        backlog.add((TELEMETRY, VEHICLE, 0.0), known=True)
    assert all(backlog.add((CONTROL, VEHICLE, 0.0), known=True) for _ in range(MAX_RARE))
    assert not backlog.add((TELEMETRY, VEHICLE, 0.0), known=True)


def test_the_backlog_is_bounded_however_many_senders_there_are():
    backlog = Backlog(100)
    for number in range(10_000):
        backlog.add((TELEMETRY, ("10.0.0.9", number), 0.0), known=False)
    assert len(backlog) == 100
    assert backlog.add((CONTROL, VEHICLE, 0.0), known=True), "a known sender still has room"
    for number in range(10_000):
        backlog.add((TELEMETRY, ("10.0.0.9", number), 0.0), known=True)
    assert len(backlog) <= 200


def test_a_backlog_that_is_full_of_known_senders_has_room_for_a_new_one():
    backlog = Backlog(800)
    for number in range(20_000):
        backlog.add((TELEMETRY, ("10.0.0.9", number % 100), 0.0), known=True)
    assert len(backlog) >= 700
    assert backlog.add((CONTROL, VEHICLE, 0.0), known=False)
    for number in range(20_000):
        backlog.add((TELEMETRY, ("10.0.0.8", number), 0.0), known=False)
    assert len(backlog) <= 1600
    backlog.clear()
    assert backlog.add((CONTROL, VEHICLE, 0.0), known=False)


def test_senders_that_were_new_at_first_leave_room_for_a_new_one():
    backlog = Backlog(800)
    for number in range(20_000):
        backlog.add((TELEMETRY, ("10.0.0.9", number % 100), 0.0), known=number > 5000)
        if number > 5000:
            backlog.pop()
            backlog.add((TELEMETRY, ("10.0.0.9", number % 100), 0.0), known=True)
    assert backlog.add((CONTROL, VEHICLE, 0.0), known=False)
