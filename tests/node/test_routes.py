"""The routes to addresses."""

from __future__ import annotations

from mavstack.node.routes import MAX_ADDRESSES, MAX_CHANNELS, MAX_WIDE, SILENCE_TIMEOUT, Routes
from mavstack.services import BROADCAST, Address

A, B, C = "radio", "wifi", "usb"
ALL = (A, B, C)
COPTER, CAMERA = Address(1, 1), Address(1, 100)


def test_the_route_of_an_address_is_its_channel() -> None:
    routes: Routes[str] = Routes()
    routes.learn(COPTER, A, 0.0)
    routes.learn(Address(2, 1), B, 0.0)
    assert list(routes.channels_to(COPTER, ALL)) == [A]
    assert list(routes.channels_to(Address(2, 1), ALL)) == [B]


def test_the_route_of_an_unknown_component_is_that_of_its_system() -> None:
    routes: Routes[str] = Routes()
    routes.learn(COPTER, A, 0.0)
    routes.learn(CAMERA, B, 0.0)
    assert list(routes.channels_to(Address(1, 0), ALL)) == [A, B]
    assert list(routes.channels_to(Address(1, 55), ALL)) == [A, B]


def test_broadcasts_and_unknown_systems_use_all_channels() -> None:
    routes: Routes[str] = Routes()
    routes.learn(COPTER, A, 0.0)
    assert list(routes.channels_to(BROADCAST, ALL)) == list(ALL)
    assert list(routes.channels_to(Address(9, 1), ALL)) == list(ALL)


def test_packets_of_others_go_over_all_channels_that_heard_their_target() -> None:
    routes: Routes[str] = Routes()
    routes.learn(COPTER, A, 0.0)
    routes.learn(COPTER, B, 0.0)
    routes.learn(CAMERA, C, 0.0)
    assert routes.all_channels_to(COPTER, ALL) == [A, B]
    assert routes.all_channels_to(CAMERA, ALL) == [C]
    assert routes.all_channels_to(Address(1, 55), ALL) == [A, B, C]
    assert routes.all_channels_to(BROADCAST, ALL) == ALL
    assert routes.all_channels_to(Address(9, 1), ALL) == []
    routes.learn(COPTER, B, 0.0, verified=True)
    assert routes.all_channels_to(COPTER, ALL) == [B]
    assert routes.all_channels_to(Address(1, 0), ALL) == [B]


def test_system_0_is_never_learned() -> None:
    routes: Routes[str] = Routes()
    for address in (Address(0, 1), BROADCAST):
        routes.learn(address, A, 0.0)
    assert list(routes.channels_to(Address(1, 1), ALL)) == list(ALL)
    assert routes.heard_on(BROADCAST) == ()


def test_the_route_of_component_0_is_that_of_its_system() -> None:
    """Programs with pymavlink send as component 0 by default."""
    routes: Routes[str] = Routes()
    routes.learn(Address(250, 0), A, 0.0)
    assert routes.heard_on(Address(250, 0)) == (A,)
    assert list(routes.channels_to(Address(250, 0), ALL)) == [A]
    routes.learn(Address(250, 191), B, 0.0)
    assert list(routes.channels_to(Address(250, 0), ALL)) == [A, B]
    assert list(routes.channels_to(Address(250, 191), ALL)) == [B]
    routes.remove_channel(A)
    assert list(routes.channels_to(Address(250, 0), (B, C))) == [B]


def test_the_first_of_two_channels_is_preferred_until_it_is_silent() -> None:
    routes: Routes[str] = Routes()
    for tenth in range(30):
        routes.learn(COPTER, A, tenth / 10)
        routes.learn(COPTER, B, tenth / 10)
        assert list(routes.channels_to(COPTER, ALL)) == [A]
    routes.learn(COPTER, B, 2.9 + SILENCE_TIMEOUT)
    assert list(routes.channels_to(COPTER, ALL)) == [B]
    routes.learn(COPTER, A, 2.9 + SILENCE_TIMEOUT)
    assert list(routes.channels_to(COPTER, ALL)) == [B]


def test_learn_returns_whether_an_address_is_heard_on_several_channels() -> None:
    routes: Routes[str] = Routes()
    assert [routes.learn(COPTER, channel, 0.0) for channel in (A, A, B, A)] == [False, False, True, True]
    assert not routes.learn(CAMERA, B, 0.0)
    routes.remove_channel(B)
    assert not routes.learn(COPTER, A, 1.0)


def test_a_closed_channel_is_removed_from_all_routes() -> None:
    routes: Routes[str] = Routes()
    routes.learn(COPTER, A, 0.0)
    routes.learn(COPTER, B, 1.0)
    routes.learn(CAMERA, A, 1.0)
    routes.remove_channel(A)
    assert list(routes.channels_to(COPTER, (B, C))) == [B]
    assert list(routes.channels_to(CAMERA, (B, C))) == [B]
    routes.remove_channel(B)
    assert list(routes.channels_to(COPTER, (C,))) == [C]


def test_the_number_of_addresses_is_bounded() -> None:
    routes: Routes[str] = Routes()
    for number in range(2 * MAX_ADDRESSES):
        routes.learn(Address(1 + number % 255, 1 + number // 255 % 255), A, float(number))
    assert len(routes._routes) == MAX_ADDRESSES
    assert sum(len(system) for system in routes._systems.values()) == MAX_ADDRESSES


def test_the_channels_of_all_addresses_are_bounded_in_total() -> None:
    routes: Routes[int] = Routes()
    for channel in range(64):
        for number in range(1000):
            routes.learn(Address(1 + number % 250, 1 + number // 250), channel, channel / 100)
    addresses = [Address(1 + number % 250, 1 + number // 250) for number in range(1000)]
    counts = [len(routes.heard_on(address)) for address in addresses]
    assert sum(counts) <= 1000 * MAX_CHANNELS + MAX_WIDE * 64
    narrow = next(address for address in addresses if len(routes.heard_on(address)) <= MAX_CHANNELS)
    assert list(routes.channels_to(narrow, range(64))) == [0], "the preferred channel stays"


def test_an_address_with_many_channels_keeps_its_verified_ones() -> None:
    routes: Routes[int] = Routes()
    for number in range(20):
        routes.learn(COPTER, number, 0.0)
    routes.learn(COPTER, 19, 1.0, verified=True)
    routes.learn(COPTER, 18, 1.5, verified=True)
    for number in range(20, 40):
        routes.learn(COPTER, number, 2.0 + number)
    for system in range(2, 3 + MAX_WIDE):
        for number in range(MAX_CHANNELS + 1):
            routes.learn(Address(system, 1), number, 60.0)
    assert routes.heard_on(COPTER) == (19, 18, 38, 39)
    assert routes.verified_on(COPTER) == {18, 19}
