"""The list of logs: missing entries are requested again."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.services.log import LogClient
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import packet_of, sent_by


def listed(*entries: tuple[int, int], last: int = 9) -> tuple:
    """Answer a list request with (id, number of logs) entries; return the operation and its next requests."""
    client = LogClient(GROUND, VEHICLE)
    operation = client.list_logs(START)
    sent_by(client)
    for number, total in entries:
        client.receive(packet_of(common.LogEntry(id=number, num_logs=total, last_log_num=last)), START)
    requests = [message for message in sent_by(client) if isinstance(message, common.LogRequestList)]
    return operation, [(request.start, request.end) for request in requests]


def test_a_gap_in_the_list_is_requested_by_its_ids() -> None:
    assert listed((1, 6), (2, 6), (5, 6), (6, 6), last=6)[1] == [(3, 4)]


def test_if_an_end_of_the_list_is_missing_all_is_requested() -> None:
    assert listed((2, 4), (3, 4), (4, 4), last=4)[1] == [(0, 0xFFFF)]


def test_a_list_that_changes_its_length_begins_again() -> None:
    operation, _ = listed((5, 3), (1, 2), (2, 2))
    assert [entry.id for entry in operation.result()] == [1, 2]
