"""The claims of senders on addresses."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.security.senders import Authority, BootClock, Claims, Contradiction, Sender, Standing

VEHICLE = (1, 1)
PLACE = "udp:14550"


def stranger(port: int = 1, host: str = "10.0.0.9") -> Sender:
    return Sender(PLACE, f"{host}:{port}")


def two() -> Claims[str]:
    """A table with a first sender, which holds 1/1, and a second one."""
    claims: Claims[str] = Claims()
    assert claims.open("first", stranger(1), 0.0)
    assert claims.open("second", stranger(2), 0.0)
    assert claims.hear("first", VEHICLE, 0.0) is Standing.NEW
    return claims


def test_the_first_sender_holds_an_address_and_a_contested_claim_leads_nowhere() -> None:
    claims = two()
    assert claims.hear("second", VEHICLE, 0.1) is Standing.CONTESTED
    assert claims.hear("first", VEHICLE, 0.2) is Standing.HELD
    assert claims.routes(VEHICLE) == claims.routes((1, 0)) == ["first"]
    assert claims.routes((2, 1)) is None
    holder, other = claims.claims_on(VEHICLE)
    assert (holder.key, holder.sender, holder.heard_at) == ("first", stranger(1), 0.2)
    assert (other.key, other.leads, other.authority) == ("second", False, Authority.NONE)
    claims.close("first")
    assert claims.routes(VEHICLE) == ["second"]
    assert claims.sender("first") is None


def test_an_authenticated_sender_holds_its_address_against_all_others() -> None:
    claims = two()
    assert claims.hear("second", VEHICLE, 0.1, Authority.KEY) is Standing.HELD
    assert claims.hear("first", VEHICLE, 100.0) is Standing.OUTRANKED
    assert claims.is_authenticated(VEHICLE)
    assert not claims.contradict("first", VEHICLE, Contradiction.POSITION, 100.0)
    claims.withdraw("second")
    assert not claims.is_authenticated(VEHICLE)
    claims.authenticate("first", Authority.CERTIFICATE, "pilot")
    assert claims.standing("first", VEHICLE, 100.0) is Standing.HELD
    assert claims.hear("first", VEHICLE, 100.0) is Standing.HELD
    assert claims.sender("first") == Sender(PLACE, "10.0.0.9:1", Authority.CERTIFICATE, "pilot")


def test_clocks_reboots_and_ground_stations() -> None:
    claims = two()
    claims.hear("second", VEHICLE, 0.0)
    assert claims.note_boot_time("first", VEHICLE, 90_000, 0.0) is BootClock.AGREES
    assert claims.note_boot_time("second", VEHICLE, 91_000, 1.0) is BootClock.AGREES
    assert claims.hear("second", VEHICLE, 1.0) is Standing.SHARED
    assert claims.note_boot_time("second", VEHICLE, 5_000, 1.0) is BootClock.DIFFERS
    assert claims.note_boot_time("first", VEHICLE, 5_000, 1.0) is BootClock.REBOOTED
    station = (255, 190)
    for key in ("first", "second", "second"):
        standing = claims.hear(key, station, 1.0)
        claims.note_ground_station(key, station, is_station=True)
    assert standing is Standing.SHARED
    assert claims.routes(station) == ["first", "second"]
    assert claims.addresses() == [VEHICLE, station]


def test_a_conflict_begins_and_ends() -> None:
    claims = two()
    claims.hear("second", VEHICLE, 0.0)
    assert claims.conflict(VEHICLE) is None
    assert claims.contradict("second", VEHICLE, Contradiction.UNIQUE_ID, 1.0)
    assert not claims.contradict("second", VEHICLE, Contradiction.POSITION, 2.0)
    conflict = claims.conflict(VEHICLE)
    assert conflict is not None
    assert (conflict.began_at, conflict.contradicted_at, conflict.keys) == (1.0, 2.0, ("first", "second"))
    assert conflict.contradictions == {Contradiction.UNIQUE_ID, Contradiction.POSITION}
    assert claims.end_conflicts(31.0) == []
    claims.close("first")
    found = claims.conflict(VEHICLE)
    assert found is not None
    assert found.keys == ("second",)
    assert claims.end_conflicts(32.0) == [VEHICLE]


def test_the_senders_of_a_crowded_host_make_room_and_an_authenticated_one_does_not() -> None:
    claims: Claims[object] = Claims()
    claims.open("pilot", Sender(PLACE, "10.0.0.1:1", Authority.KEY, "pilot"), 0.0)
    for port in range(300):
        assert claims.open(port, stranger(port), 0.0)
        claims.touch(port, 5.0)
    newcomer = Sender(PLACE, "10.0.0.2:1")
    assert claims.first_to_evict(newcomer, 5.0) in range(300)
    assert claims.first_to_evict(stranger(301), 5.0) is None
    assert claims.first_to_evict(Sender("tcp:1", "10.0.0.2:1"), 5.0) is None
    assert claims.first_to_evict(Sender("tcp:1", "10.0.0.2:1"), 5.0, everywhere=True) in range(300)
    for port in range(300):
        claims.close(port)
    assert claims.first_to_evict(newcomer, 1000.0) is None


def test_a_quarantine_of_an_address_never_includes_an_identity() -> None:
    pilot = Sender(PLACE, "10.0.0.9:1", Authority.TICKET, "pilot")
    assert pilot.quarantine_key == Sender("ws:1", "10.0.0.9:2", Authority.TICKET, "pilot").quarantine_key
    assert pilot.quarantine_key != stranger(1).quarantine_key != stranger(2).quarantine_key
    assert (stranger(1).host, Sender("serial").host, Sender("u", "/run/x").host) == (
        "10.0.0.9",
        "serial",
        "/run/x",
    )
    assert str(pilot) == "udp:14550 from 10.0.0.9:1 (ticket pilot)"


def test_the_table_has_a_bounded_number_of_senders() -> None:
    claims: Claims[int] = Claims()
    opened = [claims.open(number, stranger(number), 0.0) for number in range(4100)]
    assert sum(opened) == 4096
    claims.close(0)
    assert claims.open(5000, stranger(1), 0.0)


@settings(max_examples=50, deadline=None)
@given(
    st.lists(
        st.tuples(st.integers(1, 4), st.floats(0.0, 5.0), st.sampled_from(("hear", "close", "contradict")))
    )
)
def test_nothing_unauthenticated_costs_an_authenticated_sender_its_address(
    steps: list[tuple[int, float, str]],
) -> None:
    claims: Claims[int] = Claims()
    claims.open(0, Sender("serial", authority=Authority.SESSION, identity="pilot"), 0.0)
    claims.hear(0, VEHICLE, 0.0)
    now = 0.0
    for key, wait, step in steps:
        now += wait
        if claims.sender(key) is None:
            claims.open(key, stranger(key), now)
        assert claims.hear(key, VEHICLE, now) is Standing.OUTRANKED
        if step == "close":
            claims.close(key)
        elif step == "contradict":
            claims.contradict(key, VEHICLE, Contradiction.TYPE, now)
        assert claims.routes(VEHICLE) == [0]
        assert claims.conflict(VEHICLE) is None
