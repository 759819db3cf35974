from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import Address, Priority
from mavstack.services.log import LogsErased, LogServer
from tests.services.log.store import MemoryStore
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import feed_random_messages, packet_of, sent_by

OTHER = Address(254, 1)


def server_of(*contents: bytes, **options) -> LogServer:
    return LogServer(VEHICLE, MemoryStore(dict(enumerate(contents, 1)), {1: 5, 2: 6}), **options)


def ask(server: LogServer, kind: type, source: Address = GROUND, now: float = START, **fields: int) -> None:
    server.receive(packet_of(kind(target_system=1, target_component=1, **fields), source), now)


def data(*messages: common.LogData) -> list[tuple[int, int]]:
    return [(message.ofs, message.count) for message in messages]


def test_the_list_and_parts_of_it() -> None:
    server = server_of(b"x" * 100, b"")
    ask(server, common.LogRequestList, start=0, end=0xFFFF)
    assert sent_by(server) == [
        common.LogEntry(id=1, num_logs=2, last_log_num=2, time_utc=5, size=100),
        common.LogEntry(id=2, num_logs=2, last_log_num=2, time_utc=6, size=0),
    ]
    ask(server, common.LogRequestList, start=2, end=2)
    assert [entry.id for entry in sent_by(server)] == [2]
    ask(server, common.LogRequestList, start=9, end=4)
    assert sent_by(server) == []


def test_no_logs_are_reported_by_an_entry_of_none() -> None:
    server = server_of()
    ask(server, common.LogRequestList, start=0, end=0xFFFF)
    assert sent_by(server) == [common.LogEntry(id=0, num_logs=0)]


@pytest.mark.parametrize(
    ("size", "offset", "count", "expected"),
    [
        (200, 0, 0xFFFFFFFF, [(0, 90), (90, 90), (180, 20)]),
        (180, 0, 0xFFFFFFFF, [(0, 90), (90, 90), (180, 0)]),
        (180, 0, 180, [(0, 90), (90, 90)]),
        (200, 90, 90, [(90, 90)]),
        (200, 0, 100, [(0, 90), (90, 10)]),
        (200, 45, 45, [(45, 45)]),
        (200, 5000, 90, [(5000, 0)]),
        (200, 0, 0, []),
    ],
)
def test_a_range_of_a_log(size: int, offset: int, count: int, expected: list[tuple[int, int]]) -> None:
    server = server_of(bytes(range(200))[:size])
    ask(server, common.LogRequestData, id=1, ofs=offset, count=count)
    messages = sent_by(server)
    assert data(*messages) == expected
    for message in messages:
        wanted = bytes(range(200))[message.ofs : message.ofs + message.count]
        assert message.data[: message.count] == wanted


def test_a_log_that_grows_is_given_up_to_the_size_that_it_had() -> None:
    server = server_of(b"x" * 100)
    ask(server, common.LogRequestData, id=1, ofs=0, count=0xFFFFFFFF)
    server._store.contents[1] = b"x" * 300
    assert data(*sent_by(server)) == [(0, 90), (90, 10)]


def test_a_log_that_is_not_there_gets_no_answer() -> None:
    server = server_of(b"x")
    ask(server, common.LogRequestData, id=9, ofs=0, count=90)
    assert sent_by(server) == []


def test_a_log_that_cannot_be_read_gets_no_end_that_is_none() -> None:
    server = server_of(b"x" * 200)
    server._store.broken = True
    ask(server, common.LogRequestData, id=1, ofs=0, count=200)
    assert sent_by(server) == []
    ask(server, common.LogErase)
    assert server.events() == []


def test_a_new_request_replaces_the_old_and_end_ends_it() -> None:
    server = server_of(b"x" * 900)
    ask(server, common.LogRequestData, id=1, ofs=0, count=900)
    ask(server, common.LogRequestData, id=1, ofs=810, count=90)
    assert data(*sent_by(server)) == [(810, 90)]
    ask(server, common.LogRequestData, id=1, ofs=0, count=900)
    ask(server, common.LogRequestEnd, source=OTHER)
    ask(server, common.LogRequestEnd)
    assert sent_by(server) == []


def test_several_clients_are_served_in_turn_and_each_when_it_has_room() -> None:
    server = server_of(b"x" * 900)
    ask(server, common.LogRequestData, id=1, ofs=0, count=180)
    ask(server, common.LogRequestData, source=OTHER, id=1, ofs=90, count=180)
    assert [outgoing.target for outgoing in server.messages_to_send(START)] == [GROUND, OTHER] * 2
    ask(server, common.LogRequestData, id=1, ofs=0, count=180)
    ask(server, common.LogRequestData, source=OTHER, id=1, ofs=90, count=180)

    def has_room(target: Address, priority: Priority = Priority.BULK) -> bool:
        assert priority == Priority.BULK
        return target == OTHER

    assert [outgoing.target for outgoing in server.messages_to_send(START, has_room)] == [OTHER] * 2
    assert data(*sent_by(server)) == [(0, 90), (90, 90)]


def test_each_message_is_made_only_when_there_is_room() -> None:
    server = server_of(b"x" * 9000)
    ask(server, common.LogRequestData, id=1, ofs=0, count=9000)
    room = iter([True, True, False])
    assert len(list(server.messages_to_send(START, lambda *_: next(room)))) == 2
    assert len(sent_by(server)) == 98


def test_erasing_is_reported_and_its_copy_ignored() -> None:
    server = server_of(b"x" * 900)
    ask(server, common.LogRequestData, id=1, ofs=0, count=900)
    ask(server, common.LogErase)
    assert server.events() == [LogsErased(GROUND)]
    assert sent_by(server) == []
    server._store.contents[1] = b"new"
    ask(server, common.LogErase, now=START + 0.2)
    assert server._store.contents == {1: b"new"}
    ask(server, common.LogErase, now=START + 60)
    assert server._store.contents == {}


def test_in_flight_nothing_is_given() -> None:
    server = server_of(b"x", available=lambda: False)
    ask(server, common.LogRequestList, start=0, end=0xFFFF)
    ask(server, common.LogRequestData, id=1, ofs=0, count=90)
    ask(server, common.LogErase)
    assert sent_by(server) == []
    assert server._store.contents


def test_the_table_of_clients_is_bounded() -> None:
    server = server_of(b"x" * 900)
    for number in range(1, 200):
        ask(server, common.LogRequestData, source=Address(number, 1), id=1, ofs=0, count=90)
    assert len(sent_by(server)) == 32


@pytest.mark.parametrize("seed", range(30))
def test_garbage_never_raises(seed: int) -> None:
    kinds = [common.LogRequestList, common.LogRequestData, common.LogRequestEnd, common.LogErase]
    feed_random_messages(server_of(b"x" * 900, b"y"), kinds, seed)
