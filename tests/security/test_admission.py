"""Places of full tables: who leaves for whom."""

from __future__ import annotations

import pytest

from mavstack.security.admission import (
    AUTHENTICATED_TIMEOUT,
    USE_TIMEOUT,
    Admission,
    Decision,
    Place,
    Proof,
)

NOW = 1_790_000_000.0
SILENT, SPEAKING, AUTHENTICATED = Proof


def place(name, proof=SPEAKING, *, holder="a", age=0.0):
    return Place(name, holder, proof, NOW - age)


def leaving(places, *, holder="a", proof=SILENT):
    admitted, owner = Admission(len(places)).admit(holder, places, NOW, proof)
    assert admitted == (owner is not None)
    return owner


def test_the_silent_leave_first_then_the_unused():
    unused = place("unused", age=USE_TIMEOUT + 1)
    assert leaving([place("used"), unused, place("silent", SILENT)]) == "silent"
    assert leaving([place("used"), unused]) == "unused"
    assert leaving([place("used"), place("other")]) is None


@pytest.mark.parametrize("count", [1, 64])
def test_what_is_not_authenticated_costs_an_authenticated_client_nothing(count):
    pilots = [place(f"pilot {number}", AUTHENTICATED, age=AUTHENTICATED_TIMEOUT) for number in range(count)]
    assert leaving(pilots, holder="b") is None
    assert leaving([*pilots, place("other", SILENT)], holder="b") == "other"


def test_an_authenticated_newcomer_replaces_any_other():
    others = [place(f"other {number}", age=number / 10) for number in range(10)]
    assert leaving(others, proof=AUTHENTICATED) == "other 9"
    assert leaving([place("pilot", AUTHENTICATED)], proof=AUTHENTICATED) is None


def test_authenticated_clients_that_have_left_do_not_fill_a_table():
    assert leaving([place("gone", AUTHENTICATED, age=AUTHENTICATED_TIMEOUT + 1)]) == "gone"


def test_one_address_leaves_half_of_the_places_to_others():
    flood = [place(number, age=number / 100) for number in range(3)]
    assert leaving([*flood, place("b", holder="b")], holder="c") == 2
    assert leaving([*flood, place("b", holder="b")], holder="a") is None


def test_authenticated_newcomers_are_not_limited_by_the_rate_of_others():
    admission = Admission(8)
    flood = [place(number, SILENT) for number in range(8)]
    while admission.admit("a", flood, NOW).admitted:
        pass
    assert admission.admit("a", flood, NOW, AUTHENTICATED).admitted
    assert not admission.admit("b", flood, NOW).admitted
    assert admission.admit("b", flood, NOW + 1).admitted


def test_a_table_without_a_limit_of_the_rate_takes_every_newcomer():
    admission = Admission(2, min_stay=0)
    flood = [place(number, SILENT, age=number) for number in range(2)]
    assert {admission.admit("a", flood, NOW) for _ in range(100)} == {Decision(admitted=True, leaving=1)}
