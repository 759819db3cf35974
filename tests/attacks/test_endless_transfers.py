"""S10: components whose files and logs outgrow their listing, and that send a little for ever."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import FileTimeout, ParameterTimeout, RemoteProtocolError
from mavstack.services.ftp import FtpClient, Opcode
from mavstack.services.log import LogClient, LogEntry
from mavstack.services.operation import SLOW_START
from mavstack.services.parameters import ParameterClient
from tests.services.ftp.test_pitfalls import asked, opened, reply
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, run_timers, sent_by


def test_a_file_of_unknown_size_is_bounded() -> None:
    """Before: 334 MB of a file that was listed with 100 bytes."""
    client = FtpClient(GROUND, VEHICLE)
    operation = client.download("f", START, max_size=1000, verify=False)
    reply(client, asked(client)[0], b"")  # announces no size
    (burst,) = asked(client)
    for number, offset in enumerate(range(0, 4000, 239)):
        reply(client, burst, bytes(239), offset=offset, ahead=number + 1)
    with pytest.raises(RemoteProtocolError, match="more than the 1000 bytes allowed; max_size=") as raised:
        operation.result()
    assert raised.value.limit == "max_size"


def test_an_endless_directory_is_bounded() -> None:
    client = FtpClient(GROUND, VEHICLE)
    operation = client.list_directory("d", START, max_entries=100)
    for _ in range(200):
        requests = asked(client)
        if operation.done:
            break
        reply(client, requests[0], b"Dx\0" * 20)
    with pytest.raises(
        RemoteProtocolError, match="more than the 100 entries allowed; max_entries="
    ) as raised:
        operation.result()
    assert raised.value.limit == "max_entries"


def test_a_log_that_outgrows_its_entry_is_bounded() -> None:
    client = LogClient(GROUND, VEHICLE)
    listed = LogEntry(1, 0, 100)
    operation = client.download(listed, START, max_size=5000)
    now, offset = START, 0
    for _ in range(300):
        for message in sent_by(client, now):
            if isinstance(message, common.LogRequestList):
                entry = common.LogEntry(id=1, num_logs=1, last_log_num=1, size=100)
                deliver(client, entry, VEHICLE, now)
            elif isinstance(message, common.LogRequestData):
                for offset in range(message.ofs, message.ofs + message.count, 90):
                    deliver(client, common.LogData(id=1, ofs=offset, count=90, data=bytes(90)), VEHICLE, now)
        now += 0.1
        client.handle_timeout(now)
        if operation.done:
            break
    with pytest.raises(
        RemoteProtocolError,
        match="more than the 5000 bytes allowed, its entry says 100; max_size= allows more",
    ):
        operation.result()


def answer_slowly(client, operation, message_at, interval=8.0) -> float:
    """Let a component send one message every few seconds; returns how long the operation takes it."""
    now = START
    for number in range(10_000):
        if operation.done:
            break
        deliver(client, message_at(number), VEHICLE, now, number % 256)
        sent_by(client, now)
        run_timers(client, now + interval)
        now += interval
    return now - START


def test_parameters_that_arrive_one_by_one_for_ever() -> None:
    client = ParameterClient(GROUND, VEHICLE)
    operation = client.download(START)

    def value(number):
        return common.ParamValue(
            param_id=f"P{number}", param_count=5000, param_index=number, param_value=1.0, param_type=9
        )

    took = answer_slowly(client, operation, value)
    with pytest.raises(
        ParameterTimeout, match=r"too slow, only \d+ arrived in \d+ s; timeout= allows"
    ) as raised:
        operation.result()
    assert raised.value.limit == "timeout"
    assert took <= 3 * SLOW_START


def test_a_timeout_replaces_the_minimum_rate() -> None:
    client = ParameterClient(GROUND, VEHICLE)
    operation = client.download(START, timeout=2000.0)

    def value(number):
        return common.ParamValue(
            param_id=f"P{number}", param_count=5000, param_index=number, param_value=1.0, param_type=9
        )

    took = answer_slowly(client, operation, value)
    assert 1990 <= took <= 2010
    with pytest.raises(ParameterTimeout, match=r"only \d+ arrived in 2000 s; timeout= allows more time"):
        operation.result()


def test_a_file_that_arrives_packet_by_packet_for_ever() -> None:
    client = FtpClient(GROUND, VEHICLE)
    operation, _ = opened(client, size=1 << 20)
    now = START
    while not operation.done and now < START + 10_000:
        for request in asked(client, now)[:1]:
            if request.opcode == Opcode.OPENFILERO:
                reply(client, request, (1 << 20).to_bytes(4, "little"), now=now)
            elif request.opcode in (Opcode.READFILE, Opcode.BURSTREADFILE):
                reply(client, request, bytes(239), now=now)
        now += 8.0
        client.handle_timeout(now)
    with pytest.raises(FileTimeout, match="too slow"):
        operation.result()
