from __future__ import annotations

import random

import pytest

from mavstack.links.relay_frames import (
    MAX_DATAGRAM,
    Change,
    encode_datagram,
    encode_notice,
)
from mavstack.relay.rooms import BURST_SECONDS, MESSAGE_COST, Limits, Member, Rooms
from mavstack.security.room_tickets import Seat


def nothing() -> None:
    pass


def join(rooms: Rooms, room: str, seat: Seat, now: float = 0.0, address: str = "192.0.2.1") -> Member:
    member = rooms.join(room, seat, address, nothing, now)
    assert isinstance(member, Member)
    return member


def taken(member: Member) -> list[bytes]:
    messages = []
    while (message := member.outbox.take()) is not None:
        messages.append(message)
    return messages


def test_datagrams_go_between_the_host_and_the_guest_that_they_name():
    rooms = Rooms()
    host, one, two = (join(rooms, "boat", seat) for seat in (Seat.HOST, Seat.GUEST, Seat.GUEST))
    assert taken(host) == [encode_notice(Change.CAME, 1), encode_notice(Change.CAME, 2)]
    rooms.receive(two, b"up", 0)
    assert taken(host) == [encode_datagram(2, b"up")]
    rooms.receive(host, encode_datagram(1, b"down"), 0)
    assert (taken(one), taken(two)) == ([b"down"], [])
    rooms.leave(one)
    rooms.leave(one)
    assert taken(host) == [encode_notice(Change.LEFT, 1)]


def test_rooms_do_not_reach_each_other():
    rooms = Rooms()
    host, other = join(rooms, "boat", Seat.HOST), join(rooms, "car", Seat.HOST)
    guest = join(rooms, "boat", Seat.GUEST)
    rooms.receive(guest, b"to the boat", 0)
    rooms.receive(other, encode_datagram(1, b"from the car"), 0)
    assert (len(taken(host)), taken(other), taken(guest)) == (2, [], [])
    assert rooms.counts["dropped"] == 1


def test_guests_wait_for_the_host_and_keep_their_numbers_when_it_comes_back():
    rooms = Rooms()
    guest = join(rooms, "boat", Seat.GUEST)
    rooms.receive(guest, b"nobody", 0)
    first = join(rooms, "boat", Seat.HOST)
    assert taken(first) == [encode_notice(Change.CAME, 1)]
    second = join(rooms, "boat", Seat.HOST, now=1)
    assert first.leaving == "replaced by a newer connection of the host"
    assert taken(second) == [encode_notice(Change.CAME, 1)]
    rooms.receive(first, encode_datagram(1, b"too late"), 1)
    assert taken(guest) == []
    rooms.leave(first)
    rooms.receive(guest, b"hello", 1)
    assert taken(second) == [encode_datagram(1, b"hello")]


def test_a_full_room_refuses_guests_and_takes_the_place_of_an_idle_one():
    rooms = Rooms(Limits(guests=2))
    idle, busy = (join(rooms, "boat", Seat.GUEST, address=f"192.0.2.{n}") for n in (1, 2))
    assert rooms.join("boat", Seat.GUEST, "192.0.2.3", nothing, 1) == "the room is full"
    assert join(rooms, "boat", Seat.HOST, now=1).number == 0
    assert join(rooms, "car", Seat.GUEST, now=1)
    rooms.receive(busy, b"alive", 100)
    assert join(rooms, "boat", Seat.GUEST, now=101, address="192.0.2.3").number == 3
    assert (bool(idle.leaving), bool(busy.leaving)) == (True, False)


def test_a_full_relay_refuses_rooms_but_not_a_host_that_comes_back():
    rooms = Rooms(Limits(members=2))
    join(rooms, "boat", Seat.HOST)
    join(rooms, "boat", Seat.GUEST)
    assert rooms.join("car", Seat.HOST, "192.0.2.9", nothing, 1) == "the relay is full"
    assert join(rooms, "boat", Seat.HOST, now=1)
    assert rooms.members == 2
    assert rooms.names == ["boat"]


def test_a_sender_beyond_its_pace_is_not_read_for_as_long_as_it_is_ahead():
    limits = Limits(pace=10_000)
    rooms = Rooms(limits)
    join(rooms, "boat", Seat.HOST)
    guest = join(rooms, "boat", Seat.GUEST)
    sent = pauses = 0
    now = 0.0
    while now < 10:
        pause = rooms.receive(guest, bytes(1000), now)
        sent, pauses = sent + 1, pauses + (pause > 0)
        now += pause + 0.001
    assert pauses > 50
    assert sent * (1000 + MESSAGE_COST) <= limits.pace * (10 + BURST_SECONDS) + 2000


def test_a_guest_that_floods_costs_another_guest_nothing():
    rooms = Rooms(Limits(queue=4096))
    host, loud, quiet = (join(rooms, "boat", seat) for seat in (Seat.HOST, Seat.GUEST, Seat.GUEST))
    taken(host)
    for _ in range(1000):
        rooms.receive(loud, bytes(500), 0)
    rooms.receive(quiet, b"still here", 0)
    messages = taken(host)
    assert encode_datagram(2, b"still here") in messages[:2]
    assert sum(map(len, messages)) <= 4096 + 100
    assert rooms.counts["dropped"] > 900


@pytest.mark.parametrize(
    "message", [b"", b"\0", bytes(4), bytes(9), encode_datagram(9, b"nobody"), b"\xff" * 40]
)
def test_malformed_messages_of_a_host_are_dropped(message):
    rooms = Rooms()
    host, guest = join(rooms, "boat", Seat.HOST), join(rooms, "boat", Seat.GUEST)
    rooms.receive(host, message, 0)
    assert taken(guest) == []
    assert rooms.counts["dropped"] == 1


def test_a_datagram_that_is_too_long_is_dropped():
    rooms = Rooms()
    host, guest = join(rooms, "boat", Seat.HOST), join(rooms, "boat", Seat.GUEST)
    taken(host)
    rooms.receive(guest, bytes(MAX_DATAGRAM + 1), 0)
    assert taken(host) == []


@pytest.mark.parametrize("seed", range(20))
def test_random_members_leave_nothing_behind(seed):
    """Members come, send and leave in any order; the tables stay bounded and are empty in the end."""
    chance = random.Random(seed)
    limits = Limits(members=6, guests=3, queue=2000)
    rooms, members, now = Rooms(limits), [], 0.0
    for _ in range(400):
        now += chance.random() * 5
        members = [each for each in members if not each.leaving]
        match chance.randrange(4):
            case 0:
                seat = chance.choice(list(Seat))
                found = rooms.join(chance.choice("abc"), seat, chance.choice("xyz"), nothing, now)
                members += [found] if isinstance(found, Member) else []
            case 1 if members:
                rooms.leave(members.pop(chance.randrange(len(members))))
            case _ if members:
                sender = chance.choice(members)
                rooms.receive(sender, encode_datagram(chance.randrange(5), bytes(chance.randrange(900))), now)
        assert rooms.members == len([each for each in members if not each.leaving]) <= limits.members
    for member in members:
        rooms.leave(member)
    assert (rooms.members, rooms.names) == (0, [])
