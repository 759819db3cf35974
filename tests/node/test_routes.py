"""Which channel leads to whom."""

from __future__ import annotations

from mavstack.node.routes import MAX_ADDRESSES, SILENCE_TIMEOUT, Routes
from mavstack.services import EVERYBODY, Address

A, B, C = "radio", "wifi", "usb"
ALL = (A, B, C)
COPTER, CAMERA = Address(1, 1), Address(1, 100)


def test_an_address_is_reached_where_it_was_heard() -> None:
    routes: Routes[str] = Routes()
    routes.learn(COPTER, A, 0.0)
    routes.learn(Address(2, 1), B, 0.0)
    assert list(routes.channels_to(COPTER, ALL)) == [A]
    assert list(routes.channels_to(Address(2, 1), ALL)) == [B]


def test_a_component_never_heard_is_reached_where_its_system_was() -> None:
    routes: Routes[str] = Routes()
    routes.learn(COPTER, A, 0.0)
    routes.learn(CAMERA, B, 0.0)
    assert list(routes.channels_to(Address(1, 0), ALL)) == [A, B]
    assert list(routes.channels_to(Address(1, 55), ALL)) == [A, B]


def test_everybody_and_the_unknown_are_reached_everywhere() -> None:
    routes: Routes[str] = Routes()
    routes.learn(COPTER, A, 0.0)
    assert list(routes.channels_to(EVERYBODY, ALL)) == list(ALL)
    assert list(routes.channels_to(Address(9, 1), ALL)) == list(ALL)


def test_system_0_is_never_learned() -> None:
    routes: Routes[str] = Routes()
    for address in (Address(0, 1), EVERYBODY):
        routes.learn(address, A, 0.0)
    assert list(routes.channels_to(Address(1, 1), ALL)) == list(ALL)
    assert routes.heard_on(EVERYBODY) == ()


def test_who_sends_as_component_0_is_reached_where_its_system_was_heard() -> None:
    """As programs with pymavlink do, unless they say otherwise."""
    routes: Routes[str] = Routes()
    routes.learn(Address(250, 0), A, 0.0)
    assert routes.heard_on(Address(250, 0)) == (A,)
    assert list(routes.channels_to(Address(250, 0), ALL)) == [A]
    routes.learn(Address(250, 191), B, 0.0)
    assert list(routes.channels_to(Address(250, 0), ALL)) == [A, B]
    assert list(routes.channels_to(Address(250, 191), ALL)) == [B]
    routes.remove_channel(A)
    assert list(routes.channels_to(Address(250, 0), (B, C))) == [B]


def test_of_two_links_the_first_stays_until_it_falls_silent() -> None:
    routes: Routes[str] = Routes()
    for tenth in range(30):
        routes.learn(COPTER, A, tenth / 10)
        routes.learn(COPTER, B, tenth / 10)
        assert list(routes.channels_to(COPTER, ALL)) == [A]
    routes.learn(COPTER, B, 2.9 + SILENCE_TIMEOUT)
    assert list(routes.channels_to(COPTER, ALL)) == [B]
    routes.learn(COPTER, A, 2.9 + SILENCE_TIMEOUT)
    assert list(routes.channels_to(COPTER, ALL)) == [B]


def test_it_tells_who_is_heard_on_more_than_one_channel() -> None:
    routes: Routes[str] = Routes()
    assert [routes.learn(COPTER, channel, 0.0) for channel in (A, A, B, A)] == [False, False, True, True]
    assert not routes.learn(CAMERA, B, 0.0)
    routes.remove_channel(B)
    assert not routes.learn(COPTER, A, 1.0)


def test_a_closed_channel_leads_to_nobody() -> None:
    routes: Routes[str] = Routes()
    routes.learn(COPTER, A, 0.0)
    routes.learn(COPTER, B, 1.0)
    routes.learn(CAMERA, A, 1.0)
    routes.remove_channel(A)
    assert list(routes.channels_to(COPTER, (B, C))) == [B]
    assert list(routes.channels_to(CAMERA, (B, C))) == [B]
    routes.remove_channel(B)
    assert list(routes.channels_to(COPTER, (C,))) == [C]


def test_memory_is_bounded() -> None:
    routes: Routes[str] = Routes()
    for number in range(2 * MAX_ADDRESSES):
        routes.learn(Address(1 + number % 255, 1 + number // 255 % 255), A, float(number))
    assert len(routes._routes) == MAX_ADDRESSES
    assert sum(len(system) for system in routes._systems.values()) == MAX_ADDRESSES
