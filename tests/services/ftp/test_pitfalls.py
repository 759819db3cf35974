"""Pitfalls of the file transfer protocol, one test each."""

from __future__ import annotations

from itertools import pairwise
from random import Random

import pytest

from mavstack.errors import (
    FileDenied,
    FileTimeout,
    InvalidArgumentError,
    RemoteCancelled,
    RemoteProtocolError,
)
from mavstack.services import Address, Progress
from mavstack.services.ftp import FtpClient, FtpError, FtpPayload, FtpServer, MemoryStore, Opcode
from mavstack.services.ftp.sessions import IDLE_TIMEOUT, MAX_SESSIONS_PER_CLIENT
from tests.services.ftp.harness import FtpHarness
from tests.services.ftp.raw_requests import asked, nak, reply
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, sent_by

DATA = Random(1).randbytes(5000)


def ask(server, opcode, data=b"", *, sequence=1, source=GROUND, now=START, **fields) -> list[FtpPayload]:
    request = FtpPayload.request(opcode, data, **fields).numbered(sequence)
    deliver(server, request.to_message(*VEHICLE), source, now)
    return [FtpPayload.read(message) for message in sent_by(server, now)]


@pytest.fixture
def client() -> FtpClient:
    return FtpClient(GROUND, VEHICLE)


@pytest.fixture
def server() -> FtpServer:
    return FtpServer(VEHICLE, MemoryStore({"f": DATA, "d/g": b"1"}))


def opened(client, size=1000, session=0, **options):
    operation = client.download("f", START, **options)
    reply(client, asked(client)[0], size.to_bytes(4, "little"), session=session)
    return operation, asked(client)


# The client


def test_a_retry_repeats_its_sequence_number(client) -> None:
    operation = client.checksum("f", START)
    first = asked(client)
    while not operation.done:
        due = client.next_timeout()
        client.handle_timeout(due)
        assert all(again == first[0] for again in asked(client, due))
    with pytest.raises(
        FileTimeout, match=r"computing the checksum of f on 1/1 failed after \d+ attempts: no answer"
    ):
        operation.result()


def test_data_is_written_at_its_offset_and_the_session_may_be_0(client) -> None:
    operation, (burst,) = opened(client)
    assert (burst.opcode, burst.session) == (Opcode.BURSTREADFILE, 0)
    pieces = [(offset, DATA[offset : min(offset + 239, 1000)]) for offset in range(0, 1000, 239)]
    for number, (offset, piece) in reversed(list(enumerate(pieces))):
        reply(client, burst, piece, offset=offset, ahead=number + 1)
    assert operation.transfer.result() == DATA[:1000]


def test_packets_of_an_earlier_transfer_do_not_get_into_the_next(client) -> None:
    first, (late,) = opened(client)
    client.cancel(first, START)
    reply(client, asked(client)[0])  # the session's end
    operation, (burst,) = opened(client)
    reply(client, late, bytes(239), offset=0)
    for number, offset in enumerate(range(0, 1000, 239)):
        reply(client, burst, DATA[offset : min(offset + 239, 1000)], offset=offset, ahead=number + 1)
    assert operation.transfer.result() == DATA[:1000]


def test_a_late_end_of_file_does_no_harm(client) -> None:
    operation, (burst,) = opened(client)
    nak(client, burst, FtpError.EOF, offset=1000, ahead=6)
    assert not operation.done
    reads = [
        request for request in asked(client) if request.opcode in (Opcode.READFILE, Opcode.BURSTREADFILE)
    ]
    assert reads


def test_a_lost_end_of_burst_is_a_silence(client) -> None:
    operation, (burst,) = opened(client, size=5000)
    reply(client, burst, DATA[:239], offset=0)
    client.handle_timeout(client.next_timeout())
    again = asked(client)[-1]
    assert (again.opcode, again.offset) == (Opcode.BURSTREADFILE, 239)
    assert not operation.done


def test_a_server_without_bursts_is_read_plainly(client) -> None:
    _, (burst,) = opened(client)
    nak(client, burst, FtpError.UNKNOWNCOMMAND)
    assert [request.opcode for request in asked(client)] == [Opcode.READFILE] * 4
    assert client.server.no_bursts


def test_a_server_that_never_answers_bursts_is_read_plainly(client) -> None:
    opened(client)
    for _ in range(3):
        client.handle_timeout(client.next_timeout())
    assert [request.opcode for request in asked(client)][-1] == Opcode.READFILE


def test_a_stale_errno_in_place_of_the_end_of_a_listing(client) -> None:
    operation = client.list_directory("d", START)
    reply(client, asked(client)[0], b"Fa\t1\0S\0")
    (second,) = asked(client)
    assert second.offset == 2
    nak(client, second, FtpError.FILEEXISTS)
    assert [entry.name for entry in operation.result()] == ["a"]


def test_times_fall_back_to_the_plain_listing(client) -> None:
    operation = client.list_directory("d", START, with_time=True)
    (first,) = asked(client)
    assert first.opcode == Opcode.LISTDIRECTORYWITHTIME
    nak(client, first, FtpError.UNKNOWNCOMMAND)
    (second,) = asked(client)
    assert second.opcode == Opcode.LISTDIRECTORY
    reply(client, second)
    assert operation.result() == ()


def test_an_errno_is_reported(client) -> None:
    operation = client.remove("f", START)
    nak(client, asked(client)[0], FtpError.FAILERRNO, 30)
    with pytest.raises(FileDenied, match="errno 30"):
        operation.result()
    assert (operation.error.code, operation.error.errno) == (FtpError.FAILERRNO, 30)


def test_a_repeated_removal_that_finds_nothing_has_worked(client) -> None:
    operation = client.remove("f", START)
    (request,) = asked(client)
    client.handle_timeout(client.next_timeout())
    nak(client, request, FtpError.FILENOTFOUND)
    assert operation.error is None


def test_the_first_refusal_of_a_removal_is_final(client) -> None:
    operation = client.remove("f", START)
    nak(client, asked(client)[0], FtpError.FILENOTFOUND)
    with pytest.raises(FileDenied):
        operation.result()


def test_repetitions_wait_longer_each_time(client) -> None:
    client.remove("f", START)
    times = [START]
    for _ in range(5):
        asked(client, times[-1])
        times.append(client.next_timeout())
        client.handle_timeout(times[-1])
    waits = [round(after - before, 3) for before, after in pairwise(times)]
    assert waits == [0.5, 1.0, 2.0, 2.0, 2.0]


def test_a_repeated_creation_of_a_directory_that_reports_eexist_has_worked(client) -> None:
    operation = client.make_directory("d", START)
    (request,) = asked(client)
    client.handle_timeout(client.next_timeout())
    nak(client, request, FtpError.FAILERRNO, 17)
    assert operation.error is None


def test_a_reply_remembered_from_another_client_is_requested_again_under_a_new_number(client) -> None:
    operation = client.remove("f", START)
    (request,) = asked(client)
    reply(client, request, req_opcode=Opcode.TERMINATESESSION)
    (again,) = asked(client)
    assert again.sequence != request.sequence
    reply(client, again, req_opcode=Opcode.TERMINATESESSION)
    assert asked(client) == [], "a second number would not help either"
    reply(client, again)
    assert operation.done


def test_a_session_left_open_is_reset_once(client) -> None:
    operation = client.download("f", START)
    nak(client, asked(client)[0], FtpError.NOSESSIONSAVAILABLE)
    (reset,) = asked(client)
    assert reset.opcode == Opcode.RESETSESSION
    reply(client, reset)
    nak(client, asked(client)[0], FtpError.NOSESSIONSAVAILABLE)
    with pytest.raises(FileDenied, match="all sessions are in use"):
        operation.result()


def test_a_cancelled_transfer_ends_its_session_before_the_next_begins(client) -> None:
    operation, _ = opened(client, session=7)
    second = client.download("g", START)
    assert asked(client) == []
    client.cancel(operation, START)
    with pytest.raises(RemoteCancelled):
        operation.result()
    (end,) = asked(client)
    assert (end.opcode, end.session) == (Opcode.TERMINATESESSION, 7)
    reply(client, end)
    assert [request.data for request in asked(client)] == [b"g"]
    assert not second.done


def test_a_session_whose_number_is_not_known_is_ended_by_a_reset(client) -> None:
    operation = client.download("f", START)
    asked(client)
    client.cancel(operation, START)
    assert [request.opcode for request in asked(client)] == [Opcode.RESETSESSION]


def test_what_changes_something_waits_for_the_rest(client) -> None:
    client.remove("f", START)
    client.list_directory("d", START)
    assert [request.opcode for request in asked(client)] == [Opcode.REMOVEFILE]


def test_a_file_with_another_checksum_is_an_error() -> None:
    harness = FtpHarness(store=MemoryStore({"f": DATA}))
    operation = harness.client.download("f", harness.now)
    harness.server._continue_crc = lambda work: FtpPayload(
        work.request.sequence + 1, Opcode.ACK, size=4, req_opcode=Opcode.CALCFILECRC, data=bytes(4)
    )
    harness.run(operation)
    with pytest.raises(RemoteProtocolError, match="changed during the download"):
        operation.result()


def test_a_file_that_gets_shorter_is_an_error(client) -> None:
    operation, (burst,) = opened(client)
    reply(client, burst, DATA[239:478], offset=239, ahead=2)
    nak(client, burst, FtpError.EOF, offset=100, ahead=3)
    with pytest.raises(RemoteProtocolError, match="shorter"):
        operation.result()


def test_a_virtual_file_may_be_shorter_than_announced(client) -> None:
    operation = client.download("@PARAM/param.pck", START)
    reply(client, asked(client)[0], (1 << 20).to_bytes(4, "little"), session=3)
    (burst,) = asked(client)
    reply(client, burst, DATA[:100], offset=0, session=3)
    nak(client, burst, FtpError.EOF, offset=100, ahead=2, session=3)
    assert operation.result() == DATA[:100]


def test_progress_is_that_of_the_whole_operation() -> None:
    harness = FtpHarness(store=MemoryStore({"f": DATA}))
    operation = harness.run(harness.client.download("f", harness.now))
    reported = [(event.done, event.total) for event in harness.ground.events_of(Progress)]
    assert reported[-1] == (len(DATA), len(DATA))
    assert {event.operation for event in harness.ground.events_of(Progress)} == {operation}


def test_a_range_of_a_file() -> None:
    harness = FtpHarness(store=MemoryStore({"f": DATA}))
    operation = harness.run(harness.client.download("f", harness.now, offset=100, size=1000))
    assert operation.result() == DATA[100:1100]
    beyond = harness.run(harness.client.download("f", harness.now, offset=4990, size=1000))
    assert beyond.result() == DATA[4990:]


def test_a_server_busy_with_a_request_is_not_given_up_at_once(client) -> None:
    client.server.round_trip.add_sample(0.001)
    operation = client.checksum("f", START)
    while client.next_timeout() <= START + 8:
        client.handle_timeout(client.next_timeout())
        asked(client)
    assert not operation.done


def test_an_empty_and_a_huge_file(client) -> None:
    operation, (end,) = opened(client, size=0, verify=False)
    assert operation.result() == b""
    reply(client, end)
    operation, _ = opened(client, size=0xFFFFFFF0)
    with pytest.raises(RemoteProtocolError, match="more than"):
        operation.result()


def test_misuse_raises_at_once(client) -> None:
    for wrong in (
        lambda: client.remove("", START),
        lambda: client.rename("x" * 120, "y" * 120, START),
        lambda: client.truncate("f", -1, START),
        lambda: client.download("f", START, offset=-1),
    ):
        with pytest.raises(InvalidArgumentError):
            wrong()


# The server


def test_a_repeated_request_is_not_carried_out_again(server) -> None:
    first = ask(server, Opcode.REMOVEFILE, b"f", sequence=9)
    assert ask(server, Opcode.REMOVEFILE, b"f", sequence=9, now=START + 20) == first
    assert ask(server, Opcode.REMOVEFILE, b"f", sequence=10)[0].error == FtpError.FILENOTFOUND
    assert first[0].sequence == 10


def test_a_late_copy_of_the_creation_does_not_empty_the_file(server) -> None:
    (created,) = ask(server, Opcode.CREATEFILE, b"n", sequence=1)
    ask(server, Opcode.WRITEFILE, b"data", sequence=2, session=created.session)
    ask(server, Opcode.TERMINATESESSION, sequence=3, session=created.session)
    ask(server, Opcode.CREATEFILE, b"n", sequence=1, now=START + 0.5)
    assert server.store["n"] == b"data"
    assert len(server.sessions) == 0


def test_the_errors_of_a_server(server) -> None:
    code = [
        ask(server, Opcode.OPENFILERO, b"no", sequence=1)[0].error,
        ask(server, Opcode.READFILE, size=9, session=99, sequence=2)[0].error,
        ask(server, Opcode.CREATEDIRECTORY, b"d", sequence=3)[0].error,
        ask(server, Opcode.REMOVEDIRECTORY, b"d", sequence=4)[0].error,
        ask(server, Opcode.LISTDIRECTORY, b"d", offset=1, sequence=5)[0].error,
        ask(server, 77, sequence=6)[0].error,
        ask(server, Opcode.RENAME, b"f", sequence=7)[0].error,
        ask(server, Opcode.OPENFILERO, b"../f", sequence=8)[0].error,
        ask(server, Opcode.OPENFILERO, size=240, sequence=9)[0].error,
    ]
    assert code == [10, 4, 8, 2, 6, 7, 3, 9, 3]


def test_read_only() -> None:
    server = FtpServer(VEHICLE, MemoryStore({"f": DATA}), read_only=True)
    changes = (6, 7, 8, 9, 10, 11, 12, 13)
    replies = [ask(server, opcode, b"f", sequence=opcode, now=START + opcode)[0] for opcode in changes]
    assert {reply.error for reply in replies} == {FtpError.FILEPROTECTED}
    assert server.store["f"] == DATA  # type: ignore[index]
    assert ask(server, Opcode.CALCFILECRC, b"f", sequence=20, now=START + 20)[0].error is None


def test_sessions_are_bounded_and_end_when_idle(server) -> None:
    for number in range(MAX_SESSIONS_PER_CLIENT):
        assert ask(server, Opcode.OPENFILERO, b"f", sequence=number, session=number)[0].error is None
    assert (
        ask(server, Opcode.OPENFILERO, b"f", sequence=100, session=100)[0].error
        == FtpError.NOSESSIONSAVAILABLE
    )
    assert ask(server, Opcode.OPENFILERO, b"f", sequence=101, session=101, now=START + 4)[0].error is None
    server.handle_timeout(START + 4 + IDLE_TIMEOUT)
    assert len(server.sessions) == 0


def test_a_session_belongs_to_its_client(server) -> None:
    (mine,) = ask(server, Opcode.OPENFILERO, b"f")
    other = Address(254, 1)
    (denied,) = ask(server, Opcode.READFILE, size=9, session=mine.session, source=other)
    assert denied.error == FtpError.INVALIDSESSION
    ask(server, Opcode.RESETSESSION, source=other, sequence=2)
    assert len(server.sessions) == 1


def test_a_burst_is_paced_and_marks_its_last_reply() -> None:
    server = FtpServer(VEHICLE, MemoryStore({"f": bytes(100_000)}))
    (session,) = ask(server, Opcode.OPENFILERO, b"f")
    request = FtpPayload.request(Opcode.BURSTREADFILE, session=session.session, size=239).numbered(5)
    deliver(server, request.to_message(*VEHICLE), GROUND, START)
    rooms = iter([True, True, False])
    first = sent_by(server, START, lambda *_: next(rooms))
    rest = [FtpPayload.read(message) for _ in range(2) for message in sent_by(server, START)]
    assert len(first) == 2
    assert [packet.sequence for packet in rest][:2] == [8, 9]
    assert [packet.burst_complete for packet in rest] == [False] * 147 + [True]


def test_a_burst_through_a_slow_link_ends_before_mavftp_gives_up() -> None:
    server = FtpServer(VEHICLE, MemoryStore({"f": bytes(100_000)}))
    (session,) = ask(server, Opcode.OPENFILERO, b"f")
    request = FtpPayload.request(Opcode.BURSTREADFILE, session=session.session, size=239).numbered(5)
    deliver(server, request.to_message(*VEHICLE), GROUND, START)
    packets = []
    for step in range(100):
        rooms = iter([True, False])
        messages = sent_by(server, START + step * 0.05, lambda *_: next(rooms, False))  # noqa: B023
        packets += [FtpPayload.read(message) for message in messages]
    assert [packet.burst_complete for packet in packets] == [False] * 60 + [True]


def test_a_burst_ends_by_eof(server) -> None:
    (session,) = ask(server, Opcode.OPENFILERO, b"d/g")
    packets = ask(server, Opcode.BURSTREADFILE, session=session.session, size=239, sequence=2)
    assert [(packet.error, packet.offset) for packet in packets] == [(None, 0), (FtpError.EOF, 1)]
