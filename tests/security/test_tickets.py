from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.security.tickets import (
    MAX_NONCES,
    SUBPROTOCOL,
    TicketRefusal,
    TicketVerifier,
    make_ticket,
    offered_ticket,
    scope_of,
)

KEY = "ados_secret"
NOW = 1_000_000
NONCE = bytes.fromhex("00112233445566778899aabbccddeeff")
PUBLISHED = (
    "v2|gs.mavlink_ws|1000000|1000030|00112233445566778899aabbccddeeff"
    "|4d99ddf7a9dc48119b137be1fe135a50f7618a77f44d3a104e5ccac9171193e7"
)


def test_the_published_ticket() -> None:
    assert make_ticket(KEY, now=NOW, nonce=NONCE) == PUBLISHED
    assert TicketVerifier(KEY).verify(PUBLISHED, NOW) is None


@pytest.mark.parametrize(
    ("ticket", "now", "reason"),
    [
        (PUBLISHED, NOW + 30, "expired"),
        (PUBLISHED, NOW - 6, "in the future"),
        (PUBLISHED.replace("7", "8"), NOW, "signature"),
        (PUBLISHED.replace("1000030", "1000090"), NOW, "signature"),
        (PUBLISHED.replace("v2", "v1"), NOW, "malformed"),
        (PUBLISHED + "|", NOW, "malformed"),
        (PUBLISHED.replace("1000030", "١٠٠٠٠٣٠"), NOW, "malformed"),
        ("", NOW, "malformed"),
        (make_ticket("other", now=NOW, nonce=NONCE), NOW, "signature"),
        (make_ticket(KEY, now=NOW, nonce=NONCE, scope="gs.video"), NOW, "another scope"),
    ],
)
def test_refused_tickets(ticket: str, now: int, reason: str) -> None:
    assert reason in (TicketVerifier(KEY).verify(ticket, now) or "")


def test_it_is_valid_until_its_last_moment_and_once() -> None:
    verifier = TicketVerifier(KEY)
    assert verifier.verify(PUBLISHED, NOW + 29.9) is None
    assert "used" in (verifier.verify(PUBLISHED, NOW) or "")


def test_a_refused_ticket_is_not_used_up() -> None:
    verifier = TicketVerifier(KEY)
    assert verifier.verify(PUBLISHED, NOW - 100)
    assert verifier.verify(PUBLISHED, NOW) is None


def test_a_long_lifetime_is_refused_though_signed(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InvalidArgumentError, match="lifetime"):
        make_ticket(KEY, now=NOW, nonce=NONCE, lifetime=121)
    monkeypatch.setattr("mavstack.security.tickets.MAX_LIFETIME", 10_000)
    long = make_ticket(KEY, now=NOW, nonce=NONCE, lifetime=121)
    monkeypatch.undo()
    assert "too long" in (TicketVerifier(KEY).verify(long, NOW) or "")


def test_nonces_are_bounded_and_expired_ones_make_room() -> None:
    verifier = TicketVerifier(KEY)
    tickets = [
        make_ticket(KEY, now=NOW, nonce=number.to_bytes(16), lifetime=30 + number % 2)
        for number in range(MAX_NONCES + 1)
    ]
    assert not any(verifier.verify(ticket, NOW) for ticket in tickets[:-1])
    assert "too many" in (verifier.verify(tickets[-1], NOW) or "")
    assert "used" in (verifier.verify(tickets[0], NOW) or "")
    later = make_ticket(KEY, now=NOW + 30, nonce=NONCE)
    assert verifier.verify(later, NOW + 30) is None


@pytest.mark.parametrize("nonce", [b"", bytes(15), bytes(17)])
def test_nonces_have_16_bytes(nonce: bytes) -> None:
    with pytest.raises(InvalidArgumentError, match="nonce"):
        make_ticket(KEY, now=NOW, nonce=nonce)


@pytest.mark.parametrize("scope", ["", "a|b", "a b", "x" * 65])
def test_scopes(scope: str) -> None:
    with pytest.raises(InvalidArgumentError, match="scope"):
        make_ticket(KEY, now=NOW, nonce=NONCE, scope=scope)


@pytest.mark.parametrize(
    ("header", "ticket"),
    [
        (f"{SUBPROTOCOL}, {PUBLISHED}", PUBLISHED),
        (f"mavlink,{SUBPROTOCOL},{PUBLISHED}", PUBLISHED),
        (PUBLISHED, None),
        (SUBPROTOCOL, None),
        ("", None),
    ],
)
def test_offered_tickets(header: str, ticket: str | None) -> None:
    assert offered_ticket(header) == ticket


@pytest.mark.parametrize("scope", ["\ud800", "gs.mavlink_ws\x00", "gs. ", "\uff47s.mavlink_ws", "a\n"])
def test_scopes_that_are_not_visible_ascii_are_malformed(scope: str) -> None:
    ticket = PUBLISHED.replace("gs.mavlink_ws", scope)
    assert TicketVerifier(KEY).verify(ticket, NOW) is TicketRefusal.MALFORMED


def test_several_scopes() -> None:
    verifier = TicketVerifier(KEY, ["gs.mavlink_ws", "gs.other"])
    other = make_ticket(KEY, now=NOW, nonce=NONCE, scope="gs.other")
    assert verifier.verify(other, NOW) is None
    assert scope_of(other) == "gs.other"


@given(st.text(st.characters(), max_size=200))
def test_any_text_is_refused_with_a_reason(text: str) -> None:
    assert TicketVerifier(KEY).verify(text, NOW)
