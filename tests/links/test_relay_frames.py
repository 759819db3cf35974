from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mavstack.links.relay_frames import (
    RELAY_PROTOCOL,
    Change,
    GuestDatagram,
    Notice,
    decode,
    encode_datagram,
    encode_notice,
    offered_room_ticket,
)

GUESTS = st.integers(1, 2**32 - 1)


@given(GUESTS, st.binary(max_size=100))
def test_datagrams_come_back(guest, data):
    assert decode(encode_datagram(guest, data)) == GuestDatagram(guest, data)


@given(st.sampled_from(Change), GUESTS)
def test_notices_come_back(change, guest):
    assert decode(encode_notice(change, guest)) == Notice(change, guest)


@given(st.binary(max_size=12))
def test_other_messages_are_malformed_and_raise_nothing(message):
    if len(message) < 4 or (message[:4] == bytes(4) and (len(message) != 9 or message[4] not in (1, 2))):
        assert decode(message) is None


def test_the_ticket_is_the_subprotocol_behind_that_of_relays():
    assert offered_room_ticket(f"{RELAY_PROTOCOL}, room1.boat") == "room1.boat"
    for words in ("", RELAY_PROTOCOL, "room1.boat", f"room1.boat, {RELAY_PROTOCOL}"):
        assert offered_room_ticket(words) == ""
