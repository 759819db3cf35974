from __future__ import annotations

import pytest
from starlette.datastructures import Headers

from mavstack.errors import InvalidArgumentError
from mavstack.http.bodies import RefusedError
from mavstack.http.request_lane import RequestHead
from mavstack.security.roles import Role
from mavstack.security.tickets import make_ticket
from mavstack.server.access import COOKIE, MAX_FAILURES, SESSION_LIFETIME, Access

PASSWORDS = {Role.OBSERVE: "watching only", Role.OPERATE: "may fly it"}


class Clock:
    now = 1_790_000_000.0

    def __call__(self) -> float:
        return self.now


def status_of(action) -> int:
    with pytest.raises(RefusedError) as caught:
        action()
    return caught.value.status


def ticket_headers(ticket: str) -> Headers:
    return Headers({"host": "localhost", "sec-websocket-protocol": f"ados-ws-ticket, {ticket}"})


def test_without_a_password_programs_of_this_machine_administer() -> None:
    access = Access()
    assert access.check_websocket(Headers({"host": "127.0.0.1:8080"}), {}).role is Role.ADMINISTER


@pytest.mark.parametrize(
    "headers",
    [
        {"host": "evil.example"},
        {"host": "localhost:8080", "origin": "https://evil.example"},
        {"host": "localhost:8080", "origin": "http://localhost:9999"},
        {"host": "localhost:8080", "origin": "null"},
        {},
    ],
)
def test_pages_of_other_sites_are_refused(headers) -> None:
    assert status_of(lambda: Access().check_page(Headers(headers))) == 403


def test_own_pages_and_listed_origins_are_served() -> None:
    access = Access(origins=["http://localhost:5173"])
    for origin in ("http://localhost:8080", "http://localhost:5173"):
        access.check_page(Headers({"host": "localhost:8080", "origin": origin}))


def test_the_role_of_a_session_is_that_of_its_password() -> None:
    access = Access(passwords=PASSWORDS, local=False)
    for role, password in PASSWORDS.items():
        client = access.log_in("10.0.0.1", password=password)
        assert client.role is access.role_of(client.session) is role
        access.log_out(client.session)
        assert access.role_of(client.session) is None


def test_an_unused_session_ends() -> None:
    clock = Clock()
    access = Access(passwords=PASSWORDS, local=False, now=clock)
    token = access.log_in("10.0.0.1", password="may fly it").session
    clock.now += SESSION_LIFETIME - 1
    assert access.role_of(token) is Role.OPERATE
    clock.now += SESSION_LIFETIME + 1
    assert access.role_of(token) is None


def test_wrong_passwords_are_limited_for_each_address() -> None:
    clock = Clock()
    access = Access(passwords=PASSWORDS, local=False, now=clock)
    wrong = [status_of(lambda: access.log_in("10.0.0.1", password="x")) for _ in range(MAX_FAILURES + 1)]
    assert wrong == [401] * MAX_FAILURES + [429]
    assert status_of(lambda: access.log_in("10.0.0.1", password="may fly it")) == 429
    assert access.log_in("10.0.0.2", password="may fly it").role is Role.OPERATE
    clock.now += 61
    assert access.log_in("10.0.0.1", password="may fly it").role is Role.OPERATE


def test_an_ipv6_network_is_one_address() -> None:
    access = Access(passwords=PASSWORDS, local=False, now=Clock())
    for number in range(MAX_FAILURES):
        assert status_of(lambda: access.log_in(f"2001:db8::{number:x}", password="x")) == 401  # noqa: B023
    assert status_of(lambda: access.log_in("2001:db8::ffff:1", password="may fly it")) == 429
    for other in ("2001:db8:0:1::1", "::ffff:10.0.0.1", "fe80::1%eth0", "unix"):
        assert access.log_in(other, password="may fly it").role is Role.OPERATE


def test_sessions_of_one_role_do_not_end_those_of_another(monkeypatch) -> None:
    monkeypatch.setattr("mavstack.server.access.MAX_SESSIONS", 2)
    clock = Clock()
    access = Access(passwords=PASSWORDS, local=False, now=clock)
    pilot = access.log_in("10.0.0.1", password="may fly it").session
    watching = []
    for _ in range(3):
        clock.now += 1
        watching.append(access.log_in("10.0.0.2", password="watching only").session)
    assert access.role_of(pilot) is Role.OPERATE
    assert [access.role_of(token) for token in watching] == [None, Role.OBSERVE, Role.OBSERVE]


def test_the_ticket_of_a_session_begins_no_other_session() -> None:
    access = Access(passwords=PASSWORDS, ticket_key="k" * 32, local=False, now=Clock())
    token = access.log_in("10.0.0.1", password="may fly it").session
    assert status_of(lambda: access.log_in("10.0.0.1", ticket=access.make_ticket(token))) == 401


def test_a_ticket_opens_one_websocket() -> None:
    clock = Clock()
    access = Access(passwords=PASSWORDS, local=False, now=clock)
    session = access.log_in("10.0.0.1", password="watching only").session
    headers = ticket_headers(access.make_ticket(session))
    assert access.check_websocket(headers, {}) == (Role.OBSERVE, session)
    assert status_of(lambda: access.check_websocket(headers, {})) == 401


def test_clients_with_the_ticket_key_make_their_own_tickets() -> None:
    clock = Clock()
    access = Access(ticket_key="k" * 32, local=False, now=clock)
    ticket = make_ticket("k" * 32, now=clock.now, nonce=bytes(16), scope="gs.mavlink_ws.operate")
    assert access.check_websocket(ticket_headers(ticket), {}).role is Role.OPERATE
    other = make_ticket("other", now=clock.now, nonce=bytes(16))
    assert status_of(lambda: access.check_websocket(ticket_headers(other), {})) == 401
    again = make_ticket("k" * 32, now=clock.now, nonce=bytes(15) + b"1")
    assert access.log_in("10.0.0.1", ticket=again).role is Role.ADMINISTER


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"local": False}, "needs a password or a ticket key"),
        ({"passwords": {Role.OPERATE: "short"}}, "8 characters"),
        ({"passwords": {Role.OPERATE: "the same one", Role.OBSERVE: "the same one"}}, "password of its own"),
    ],
)
def test_unsafe_settings_are_refused(options, text) -> None:
    with pytest.raises(InvalidArgumentError, match=text):
        Access(**options)


@pytest.mark.parametrize(
    ("role", "method", "comes_first"),
    [
        (Role.OPERATE, "GET", True),
        (Role.OPERATE, "POST", True),
        (Role.OBSERVE, "POST", False),
        (None, "POST", False),
    ],
)
def test_requests_of_sessions_that_may_act_come_first(role, method, comes_first) -> None:
    access = Access(passwords=PASSWORDS, local=False)
    token = "none" if role is None else access.log_in("10.0.0.1", password=PASSWORDS[role]).session
    shown = [(f"bearer {token}", ""), ("", f"a=b; {COOKIE}={token}"), ("", f'{COOKIE}="{token}"; a=b')]
    for authorization, cookie in shown:
        assert access.comes_first(RequestHead(method, authorization, cookie)) is comes_first


def test_without_passwords_requests_that_change_something_come_first() -> None:
    assert Access().comes_first(RequestHead("POST", "", ""))
    assert not Access().comes_first(RequestHead("GET", "", ""))
