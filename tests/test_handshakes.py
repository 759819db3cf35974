"""Handshakes under way: bounded in number, fair to hosts, and closed with their link."""

from __future__ import annotations

from mavstack.handshakes import MAX_HANDSHAKES, Handshakes


class Transport:
    """A connection from a host, which records whether it was aborted."""

    def __init__(self, host: str | None) -> None:
        self.peername = None if host is None else (host, 14550)
        self.aborted = False

    def get_extra_info(self, name: str) -> object:
        assert name == "peername"
        return self.peername

    def abort(self) -> None:
        self.aborted = True


def begin(handshakes, *hosts) -> list[Transport]:
    """Begin a handshake of each host, in this order."""
    transports = [Transport(host) for host in hosts]
    for transport in transports:
        handshakes.begin(transport)
    return transports


def test_the_oldest_of_the_largest_host_makes_room() -> None:
    handshakes = Handshakes()
    (vehicle,) = begin(handshakes, "10.0.0.1")
    attacker = begin(handshakes, *["10.0.0.2"] * (MAX_HANDSHAKES - 1))
    assert not any(each.aborted for each in (vehicle, *attacker))
    (later,) = begin(handshakes, "10.0.0.3")
    assert [each.aborted for each in (vehicle, *attacker, later)] == [False, True] + [False] * (
        MAX_HANDSHAKES - 1
    )


def test_a_handshake_that_has_ended_makes_room() -> None:
    handshakes = Handshakes()
    transports = begin(handshakes, *["10.0.0.2"] * MAX_HANDSHAKES)
    handshakes.end(transports[5])
    handshakes.end(transports[5])
    transports += begin(handshakes, None)
    assert not any(each.aborted for each in transports)


def test_a_closed_link_drops_all_handshakes_and_new_ones() -> None:
    handshakes = Handshakes()
    before = begin(handshakes, "10.0.0.1", "10.0.0.2")
    handshakes.close()
    after = begin(handshakes, "10.0.0.3")
    assert all(each.aborted for each in (*before, *after))
