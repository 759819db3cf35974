"""The places of WebSockets and streams: one observer leaves places to others, all of them to the pilots."""

from __future__ import annotations

from contextlib import ExitStack

import pytest

from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role
from mavstack.server.access import Client
from mavstack.server.client_shares import (
    MAX_OBSERVED_STREAMS,
    MAX_STREAMS,
    MAX_STREAMS_PER_SESSION,
    ClientShares,
)


def taken(shares: ClientShares, stack: ExitStack, *clients: Client) -> int:
    """Take a place for each client; return the number of those that got one."""
    count = 0
    for client in clients:
        try:
            stack.enter_context(shares.place(client))
        except RefusedError:
            continue
        count += 1
    return count


def test_one_session_has_a_share():
    """Before: 530 event streams of one observer left no connection to the pilot."""
    shares = ClientShares()
    with ExitStack() as stack:
        assert taken(shares, stack, *[Client(Role.OBSERVE, "one")] * 530) == MAX_STREAMS_PER_SESSION
        assert taken(shares, stack, Client(Role.OBSERVE, "another"), Client(Role.OPERATE, "a pilot")) == 2
    assert len(shares) == 0


def test_observers_leave_places_to_those_who_act():
    shares = ClientShares()
    with ExitStack() as stack:
        observers = [Client(Role.OBSERVE, str(number // 8)) for number in range(1000)]
        assert taken(shares, stack, *observers) == MAX_OBSERVED_STREAMS
        pilots = [Client(Role.OPERATE, f"pilot {number // 8}") for number in range(1000)]
        assert taken(shares, stack, *pilots) == MAX_STREAMS - MAX_OBSERVED_STREAMS


@pytest.mark.parametrize("role", list(Role))
def test_a_place_is_free_again_after_an_error(role):
    shares = ClientShares()
    with pytest.raises(ValueError, match="of the client"), shares.place(Client(role, "one")):
        raise ValueError("of the client")
    assert len(shares) == 0
