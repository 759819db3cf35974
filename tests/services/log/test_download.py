"""The download of a log, with a server that is the test."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.services.log import LogClient, LogEntry
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import packet_of, sent_by


class ScriptedDownload:
    """A download whose server is the test: the log list is answered, the first window is requested."""

    def __init__(self, size: int) -> None:
        self.client = LogClient(GROUND, VEHICLE)
        self.operation = self.client.download(LogEntry(1, 5, size), START)
        self.now = START
        self.receive(common.LogEntry(id=1, num_logs=1, last_log_num=1, time_utc=5, size=size))

    def receive(self, message) -> None:
        self.client.receive(packet_of(message), self.now)

    def requested_ranges(self) -> list[tuple[int, int]]:
        sent = sent_by(self.client, self.now)
        return [(m.ofs, m.count) for m in sent if isinstance(m, common.LogRequestData)]

    def wait(self) -> None:
        self.now = self.client.next_timeout()
        self.client.handle_timeout(self.now)


def test_copies_of_one_answer_are_one_claim_that_the_log_ends() -> None:
    scripted = ScriptedDownload(1000)
    for claim in range(3):
        assert scripted.requested_ranges() == [(0, 1080)], claim
        assert not scripted.operation.done
        for _ in range(5):
            scripted.receive(common.LogData(id=1, ofs=0, count=3, data=b"abc"))
        if claim < 2:
            assert scripted.requested_ranges() == [], (
                "an answer that may be doubled is not asked after at once"
            )
            scripted.wait()
    scripted.receive(common.LogEntry(id=1, num_logs=1, last_log_num=1, time_utc=5, size=1000))
    assert scripted.operation.result() == b"abc"


def test_memory_grows_by_what_was_requested() -> None:
    scripted = ScriptedDownload(0xFFFFFFFF)
    scripted.receive(common.LogData(id=1, ofs=90 << 20, count=90))
    (transfer,) = (part for part in scripted.client._running if part is not scripted.operation)
    assert len(transfer._collector._data) == 0


def test_the_next_window_is_requested_with_the_last_chunk_of_the_one_before() -> None:
    scripted = ScriptedDownload(90 * 1000 + 1)
    ((offset, count),) = scripted.requested_ranges()
    for start in range(offset, offset + count, 90):
        scripted.receive(common.LogData(id=1, ofs=start, count=90))
    assert scripted.requested_ranges() == [(count, 2 * count)]


def test_gaps_are_requested_after_the_end() -> None:
    scripted = ScriptedDownload(90 * 60 + 1)
    assert scripted.requested_ranges() == [(0, 61 * 90)]
    for chunk in (*range(10), *range(12, 60)):
        scripted.receive(common.LogData(id=1, ofs=chunk * 90, count=90))
    scripted.receive(common.LogData(id=1, ofs=5400, count=1))
    ((offset, count),) = scripted.requested_ranges()
    assert offset == 900
    assert count >= 180
