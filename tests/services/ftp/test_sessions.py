"""The client names its session; the server tells sessions apart by client and name."""

from __future__ import annotations

import pytest

from mavstack.errors import FileTimeout
from mavstack.links import Impairment
from mavstack.services import Address
from mavstack.services.ftp import FtpError, FtpServer, MemoryStore, Opcode
from mavstack.services.ftp.payload import FtpPayload
from mavstack.services.ftp.sessions import (
    IDLE_TIMEOUT_WHEN_FULL,
    MAX_SESSIONS,
    MAX_SESSIONS_PER_CLIENT,
    REPLY_LIFETIME,
    SHORT_REPLY_LIFETIME,
    ReplyCache,
    Sessions,
)
from mavstack.services.ftp.stores import BytesFile
from tests.services.ftp.harness import FtpHarness
from tests.services.ftp.test_pitfalls import START, VEHICLE, ask
from tests.services.network import GROUND

OTHER = Address(254, 1)


@pytest.fixture
def server() -> FtpServer:
    return FtpServer(VEHICLE, MemoryStore({"a": b"aaaa", "b": b"bbbb"}))


def test_the_reply_has_the_number_that_was_requested(server) -> None:
    """MAVSDK's client says 0 in every request, and looks at no reply's session."""
    for turn, path in enumerate((b"a", b"b")):
        (opened,) = ask(server, Opcode.OPENFILERO, path, sequence=10 * turn + 1, session=0)
        (read,) = ask(server, Opcode.READFILE, size=9, sequence=10 * turn + 2, session=0)
        ask(server, Opcode.TERMINATESESSION, sequence=10 * turn + 3, session=0)
        assert (opened.session, read.data) == (0, path * 4)


def test_two_clients_may_use_the_same_number(server) -> None:
    other = Address(254, 1)
    ask(server, Opcode.OPENFILERO, b"a", session=3)
    ask(server, Opcode.OPENFILERO, b"b", session=3, source=other)
    assert ask(server, Opcode.READFILE, size=9, sequence=2, session=3)[0].data == b"aaaa"
    assert ask(server, Opcode.READFILE, size=9, sequence=2, session=3, source=other)[0].data == b"bbbb"


def test_a_number_in_use_does_not_come_to_mean_another_file(server) -> None:
    ask(server, Opcode.OPENFILERO, b"a", sequence=1, session=0)
    (denied,) = ask(server, Opcode.OPENFILERO, b"b", sequence=2, session=0)
    assert denied.error == FtpError.NOSESSIONSAVAILABLE
    assert ask(server, Opcode.READFILE, size=9, sequence=3, session=0)[0].data == b"aaaa"
    later = START + IDLE_TIMEOUT_WHEN_FULL
    assert ask(server, Opcode.OPENFILERO, b"b", sequence=4, session=0, now=later)[0].error is None
    assert ask(server, Opcode.READFILE, size=9, sequence=5, session=0, now=later)[0].data == b"bbbb"
    assert len(server.sessions) == 1


def test_our_client_calls_each_session_otherwise() -> None:
    harness = FtpHarness(store=MemoryStore({"a": b"aaaa"}))
    numbers = []
    add = harness.server.sessions.add
    harness.server.sessions.add = lambda owner, number, *more, **options: (
        numbers.append(number) or add(owner, number, *more, **options)
    )
    for _ in range(3):
        assert harness.run(harness.client.download("a", harness.now)).result() == b"aaaa"
    assert numbers == [1, 2, 3]


@pytest.mark.parametrize("loss", [0.0, 0.2])
def test_a_client_resets_its_own_sessions_and_no_client_elses(loss: float) -> None:
    """Those that an earlier run left open, under numbers that it does not know."""
    harness = FtpHarness(store=MemoryStore({"a": b"aaaa"}), impairment=Impairment(loss=loss))
    other = Address(254, 1)
    for owner, number in ((GROUND, 3), (GROUND, 200), (other, 3)):
        (opened,) = ask(
            harness.server, Opcode.OPENFILERO, b"a", session=number, source=owner, now=harness.now
        )
        assert opened.error is None
    operation = harness.run(harness.client.reset_sessions(harness.now))
    assert operation.error is None
    assert [(session.owner, session.number) for session in harness.server.sessions] == [(other, 3)]
    assert harness.run(harness.client.reset_sessions(harness.now)).error is None  # that there is none is fine


def test_a_reset_waits_until_a_transfer_has_ended() -> None:
    harness = FtpHarness(store=MemoryStore({"a": bytes(5000)}))
    reading = harness.client.download("a", harness.now)
    reset = harness.run(harness.client.reset_sessions(harness.now))
    assert (reading.result(), reset.error) == (bytes(5000), None)
    assert not harness.server.sessions


def test_a_reset_that_no_client_answers_times_out() -> None:
    harness = FtpHarness(connect=False)
    operation = harness.run(harness.client.reset_sessions(harness.now))
    assert isinstance(operation.error, FileTimeout)


def full_sessions(owners: list[Address]) -> Sessions:
    """Return sessions of these owners, which were opened and used lately, one after the other."""
    sessions = Sessions()
    for number, owner in enumerate(owners):
        sessions.add(owner, number, BytesFile(b""), START + (number - len(owners)) / 100, writable=False)
    return sessions


@pytest.mark.parametrize(("more", "replaced"), [(1, False), (2, True)])
def test_a_client_takes_a_session_of_one_that_has_two_more(more: int, replaced: bool) -> None:
    """Otherwise two clients would take one session from each other in turn."""
    own = MAX_SESSIONS_PER_CLIENT - 2
    many = [OTHER] * (own + more)
    rest = [Address(100 + number, 1) for number in range(MAX_SESSIONS - own - len(many))]
    sessions = full_sessions([*many, *[GROUND] * own, *rest])
    first = next(iter(sessions))
    assert sessions.make_room(GROUND, 200, START) is replaced
    assert (first not in list(sessions)) is replaced
    assert len(sessions) == MAX_SESSIONS - replaced


@pytest.mark.parametrize(("long", "lifetime"), [(True, REPLY_LIFETIME), (False, SHORT_REPLY_LIFETIME)])
def test_a_reply_is_repeated_to_an_identical_request_of_its_client_for_a_while(long, lifetime) -> None:
    cache, reply = ReplyCache(), FtpPayload(8, Opcode.ACK).to_message(*GROUND)
    request = FtpPayload.request(Opcode.REMOVEFILE, b"a").numbered(7)
    cache.add(GROUND, request, reply, START, long=long)
    assert cache.find(GROUND, request, START + lifetime) is reply
    assert cache.find(GROUND, request, START + lifetime + 0.01) is None
    assert cache.find(OTHER, request, START) is None
    assert cache.find(GROUND, FtpPayload.request(Opcode.REMOVEFILE, b"b").numbered(7), START) is None
    assert cache.find(GROUND, request.numbered(9), START) is None
