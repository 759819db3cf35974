"""The client names its session; the server tells sessions apart by client and name."""

from __future__ import annotations

import pytest

from mavstack.errors import FileTimeout
from mavstack.links import Impairment
from mavstack.services import Address
from mavstack.services.ftp import FtpError, FtpServer, MemoryStore, Opcode
from mavstack.services.ftp.sessions import IDLE_TIMEOUT_WHEN_FULL
from tests.services.ftp.harness import FtpHarness
from tests.services.ftp.test_pitfalls import START, VEHICLE, ask
from tests.services.network import GROUND


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
