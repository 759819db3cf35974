from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.security.room_tickets import MAX_LIFETIME, RoomTicket, RoomTickets, Seat, make_room_ticket
from mavstack.security.tickets import TicketRefusal

NOW = 1_800_000_000.0


@pytest.mark.parametrize("seat", Seat)
def test_a_ticket_names_its_room_and_seat_until_it_expires(seat):
    ticket = make_room_ticket("key", "boat-7", seat, expires=NOW + 60)
    verifier = RoomTickets("key")
    assert verifier.verify(ticket, NOW) == RoomTicket("boat-7", seat, int(NOW) + 60)
    assert verifier.verify(ticket, NOW) == verifier.verify(ticket, NOW + 59)
    assert verifier.verify(ticket, NOW + 60) is TicketRefusal.EXPIRED


@given(position=st.integers(0, 200), character=st.characters(min_codepoint=33, max_codepoint=126))
def test_no_changed_ticket_is_accepted(position, character):
    ticket = make_room_ticket("key", "boat", Seat.GUEST, expires=NOW + 60)
    changed = ticket[: position % len(ticket)] + character + ticket[position % len(ticket) + 1 :]
    found = RoomTickets("key").verify(changed, NOW)
    assert isinstance(found, RoomTicket) == (changed == ticket)


@given(st.text(max_size=200))
def test_any_text_is_refused(text):
    assert isinstance(RoomTickets("key").verify(text, NOW), TicketRefusal)


def test_a_ticket_of_another_key_or_for_too_long_is_refused():
    ticket = make_room_ticket("key", "boat", Seat.HOST, expires=NOW + 60)
    assert RoomTickets("other").verify(ticket, NOW) is TicketRefusal.FORGED
    ticket = make_room_ticket("key", "boat", Seat.HOST, expires=NOW + MAX_LIFETIME + 2)
    assert RoomTickets("key").verify(ticket, NOW) is TicketRefusal.TOO_LONG


@pytest.mark.parametrize("room", ["", "Boat", "a.b", "-a", "a-", "a" * 33, "ä"])
def test_names_that_would_change_the_ticket_are_refused(room):
    with pytest.raises(InvalidArgumentError, match="room must be"):
        make_room_ticket("key", room, Seat.HOST, expires=NOW)
