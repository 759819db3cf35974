"""Admission of new peers to a full link."""

from __future__ import annotations

import pytest

from mavstack.links.admission import PeerAdmission as Admission
from mavstack.links.channel import Channel
from mavstack.security.admission import MIN_STAY
from mavstack.security.admission import USE_TIMEOUT as VALID_TIMEOUT

NOW = 1_790_000_000.0


class Peer(Channel):
    """A peer of a table; its `last_valid` is `valid` seconds ago, or never."""

    def __init__(self, table, host, *, received=0.0, valid=None) -> None:
        super().__init__("peer", f"{host}:14550", lambda channel, _: table.remove(channel))
        self.last_received = NOW - received
        self.last_valid = 0.0 if valid is None else NOW - valid
        table.append(self)

    def send_bytes(self, data) -> bool:
        return True

    def close_transport(self) -> None:
        pass


@pytest.fixture
def table():
    return []


def test_a_link_with_room_closes_no_peer(table):
    Peer(table, "a")
    assert Admission(2).admit("b", table, NOW)
    assert len(table) == 1


def test_the_idlest_peer_without_valid_packets_is_closed_first(table):
    kept = [Peer(table, "a", valid=60), Peer(table, "a", received=1)]
    Peer(table, "a", received=2)
    assert Admission(3).admit("a", table, NOW)
    assert table == kept


def test_then_the_peer_whose_valid_packets_are_oldest(table):
    kept = [Peer(table, "a", valid=VALID_TIMEOUT + 1), Peer(table, "a", valid=1)]
    Peer(table, "a", valid=VALID_TIMEOUT + 2)
    assert Admission(3).admit("a", table, NOW)
    assert table == kept


def test_peers_with_valid_packets_are_kept(table):
    for _ in range(3):
        Peer(table, "a", valid=1)
    assert not Admission(3).admit("a", table, NOW)
    assert len(table) == 3


def test_one_host_cannot_keep_all_places(table):
    for _ in range(4):
        Peer(table, "a", valid=1)
    admission = Admission(4)
    assert admission.admit("b", table, NOW)
    assert len(table) == 3
    Peer(table, "b", valid=1)
    assert not admission.admit("a", table, NOW + 10 * MIN_STAY) or table[-1].host == "b"


def test_the_host_with_more_peers_loses_one_first(table):
    kept = [Peer(table, "b", received=9), Peer(table, "a", received=1)]
    Peer(table, "a", received=2)
    assert Admission(3).admit("c", table, NOW)
    assert table == kept


def test_the_rate_of_new_peers_is_limited(table):
    admission = Admission(100)
    for _ in range(100):
        Peer(table, "a")
    admitted = 0
    for step in range(4000):
        if admission.admit("a", table, NOW + step / 1000):
            Peer(table, "a")
            admitted += 1
    assert admitted == pytest.approx(25 + 100 * 4 / MIN_STAY, abs=2)
