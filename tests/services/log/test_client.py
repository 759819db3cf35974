from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.dialects import common
from mavstack.errors import LogTimeout, RemoteCancelled, RemoteDenied, RemoteProtocolError
from mavstack.links import Impairment
from mavstack.services import Progress
from mavstack.services.log import LogClient, LogEntry, LogServer
from tests.services.log.autopilots import ArduPilotLogs, PX4Logs
from tests.services.log.store import MemoryStore
from tests.services.network import GROUND, START, VEHICLE, HalfDuplexRadio, Network
from tests.services.single_service import feed_random_messages, packet_of, sent_by

if TYPE_CHECKING:
    import builtins

SIZES = [0, 1, 89, 90, 91, 900, 30_000]
LOSSY = Impairment(loss=0.1, latency=0.02, seed=1)


class LogHarness:
    """A vehicle with logs, and a ground station."""

    def __init__(
        self, kind: type = LogServer, impairment: Impairment | None = None, sizes=SIZES, **link
    ) -> None:
        random = Random(1)
        first = 0 if kind is PX4Logs else 1
        self.store = MemoryStore({first + n: random.randbytes(size) for n, size in enumerate(sizes)})
        self.contents = dict(self.store.contents)
        self.network = Network(1, keep_packets=True)
        self.vehicle = self.network.node(VEHICLE)
        self.server = self.vehicle.engine.add(kind(VEHICLE, self.store))
        self.ground = self.network.node(GROUND)
        self.client = self.ground.engine.add(LogClient(GROUND, VEHICLE))
        self.pipes = self.network.connect(self.ground, self.vehicle, impairment, **link)

    def run(self, operation, timeout: float = 600.0):
        self.ground.engine.touch(self.client)
        assert self.network.run(lambda: operation.done, timeout=timeout), "it hangs"
        return operation

    def download(self, log):
        return self.run(self.client.download(log, self.network.now))

    def list(self):
        return self.run(self.client.list_logs(self.network.now))

    def received(self, kind: type) -> builtins.list[Any]:
        return [packet.message for packet in self.vehicle.received if isinstance(packet.message, kind)]


KINDS = pytest.mark.parametrize("kind", [LogServer, ArduPilotLogs, PX4Logs])
LINKS = pytest.mark.parametrize("impairment", [None, LOSSY], ids=["clean", "lossy"])


@KINDS
@LINKS
def test_every_log_of_every_kind_of_autopilot(kind: type, impairment: Impairment | None) -> None:
    harness = LogHarness(kind, impairment)
    entries = harness.list().result()
    assert list(entries) == harness.store.logs(), "ids may start at 0 or at 1"
    for entry in entries:
        assert harness.download(entry).result() == harness.contents[entry.id]


@pytest.mark.parametrize("kind", [LogServer, ArduPilotLogs])
def test_no_logs_are_reported_by_an_entry_of_none(kind: type) -> None:
    assert LogHarness(kind, sizes=[]).list().result() == ()


def test_a_log_by_its_id_alone() -> None:
    harness = LogHarness()
    assert harness.download(7).result() == harness.contents[7]
    error = harness.download(77).error
    assert isinstance(error, RemoteDenied)
    assert str(error) == "downloading log 77 from 1/1 failed: there is no such log"


def test_px4_that_restarted_within_a_log_is_listed_again() -> None:
    harness = LogHarness(PX4Logs, radio=HalfDuplexRadio(), bandwidth=5760.0)
    entry = harness.list().result()[-1]

    def restart() -> None:
        harness.server.listed, harness.server.sending = False, None

    harness.network.at(2.0, restart)
    assert harness.download(entry).result() == harness.contents[entry.id]


def test_a_transfer_that_got_stuck_is_ended_and_begun_again() -> None:
    harness = LogHarness(StuckLogs, radio=HalfDuplexRadio(), bandwidth=5760.0)
    entry = harness.list().result()[-1]
    harness.network.at(2.0, lambda: setattr(harness.server, "ends", 0))
    assert harness.download(entry).result() == harness.contents[entry.id]


@KINDS
def test_a_transfer_ends_by_log_request_end(kind: type) -> None:
    harness = LogHarness(kind)
    harness.download(harness.list().result()[-1])
    harness.network.run(timeout=1)
    kinds = common.LogRequestList | common.LogRequestData | common.LogRequestEnd
    messages = [p.message for p in harness.vehicle.received if isinstance(p.message, kinds)]
    assert isinstance(messages[-1], common.LogRequestEnd)


def test_cancelling_sends_log_request_end_and_the_server_stops() -> None:
    harness = LogHarness(radio=HalfDuplexRadio(), bandwidth=5760.0)
    operation = harness.client.download(7, harness.network.now)
    harness.network.at(1.0, lambda: harness.client.cancel(operation, harness.network.now))
    harness.network.at(1.0, lambda: harness.ground.engine.touch(harness.client))
    harness.run(operation)
    assert isinstance(operation.error, RemoteCancelled)
    assert not harness.client.busy
    harness.network.run(timeout=1)
    assert harness.received(common.LogRequestEnd)
    before = len(harness.ground.received)
    harness.network.run(timeout=10)
    assert len(harness.ground.received) == before


def test_progress_is_reported_of_the_download() -> None:
    harness = LogHarness()
    operation = harness.download(7)
    reported = [event for event in harness.ground.events_of(Progress) if event.operation is operation]
    done = [event.done for event in reported]
    assert done == sorted(done)
    assert (reported[-1].done, reported[-1].total) == (29_970, 30_000)


def test_no_client_there_is_a_typed_error_in_time() -> None:
    harness = LogHarness()
    harness.vehicle.restart()
    assert isinstance(harness.list().error, LogTimeout)
    assert isinstance(harness.download(LogEntry(1, 5, 5)).error, LogTimeout)
    assert isinstance(harness.run(harness.client.erase(harness.network.now)).error, LogTimeout)
    assert harness.network.now - START < 120


def test_a_vehicle_that_falls_silent_within_a_log() -> None:
    harness = LogHarness(radio=HalfDuplexRadio(), bandwidth=5760.0)
    harness.network.at(2.0, lambda: [setattr(pipe, "cut", True) for pipe in harness.pipes])
    operation = harness.download(7)
    assert isinstance(operation.error, LogTimeout)
    assert "stopped sending" in str(operation.error)


def test_the_limit_is_kept() -> None:
    harness = LogHarness(radio=HalfDuplexRadio(), bandwidth=5760.0)
    operation = harness.run(harness.client.download(7, harness.network.now, timeout=3.0))
    assert isinstance(operation.error, LogTimeout)
    assert harness.network.now - START == pytest.approx(3.0)


class StuckLogs(ArduPilotLogs):
    """Still sends to a client that is gone, and ignores others."""

    def bulk_messages(self, now, has_room):
        return super().bulk_messages(now, has_room) if self.ends else iter(())


def test_what_another_left_unfinished_is_ended_before_a_list() -> None:
    harness = LogHarness(StuckLogs)
    harness.server.sending = (1, 0, 1 << 30)
    assert list(harness.list().result()) == harness.store.logs()


def test_an_id_that_means_another_log_now_is_refused() -> None:
    harness = LogHarness()
    entry = harness.list().result()[6]
    harness.store.contents[7] = b"x" * 30_000
    harness.store.times[7] = 5
    assert isinstance(harness.download(entry).error, RemoteProtocolError)


def test_a_log_replaced_while_it_is_read_is_refused() -> None:
    harness = LogHarness(radio=HalfDuplexRadio(), bandwidth=5760.0)

    def replace() -> None:
        harness.store.contents[7], harness.store.times[7] = b"x" * 30_000, 5

    harness.network.at(2.0, replace)
    assert isinstance(harness.download(7).error, RemoteProtocolError)


def test_a_log_that_grows_while_it_is_read() -> None:
    harness = LogHarness(radio=HalfDuplexRadio(), bandwidth=5760.0)

    def grow() -> None:
        harness.store.contents[7] += b"more" * 100

    harness.network.at(2.0, grow)
    content = harness.download(7).result()
    assert harness.store.contents[7].startswith(content)
    assert len(content) >= 30_000


def test_a_size_that_is_too_large_is_approximate() -> None:
    harness = LogHarness()
    logs = harness.store.logs
    harness.store.logs = lambda: [LogEntry(log.id, log.time_utc, log.size + 3000) for log in logs()]
    assert harness.download(7).result() == harness.contents[7]


def test_the_tails_of_other_clients_do_not_end_our_log() -> None:
    harness = LogHarness(radio=HalfDuplexRadio(), bandwidth=5760.0)

    def send_to_other_client() -> None:
        for offset in range(0, 29_000, 90):
            content = harness.contents[7][offset : offset + 10]
            harness.vehicle.engine.send(
                common.LogData(id=7, ofs=offset, count=10, data=content), harness.network.now
            )

    harness.network.at(1.5, send_to_other_client)
    assert harness.download(7).result() == harness.contents[7]


def test_a_wrong_offset_or_count_is_not_taken() -> None:
    harness = LogHarness()
    operation = harness.client.download(7, START)
    for ofs, count, number in ((90 << 20, 90, 7), (45, 90, 7), (0, 91, 7), (0, 255, 7), (0, 90, 6)):
        harness.client.receive(packet_of(common.LogData(id=number, ofs=ofs, count=count)), START)
    assert harness.run(operation).result() == harness.contents[7]


def test_two_operations_go_one_after_the_other() -> None:
    client = LogClient(GROUND, VEHICLE)
    client.list_logs(START)
    client.erase(START)
    assert [type(message) for message in sent_by(client)] == [common.LogRequestList]


@pytest.mark.parametrize(
    ("kind", "impairment"), [(LogServer, None), (LogServer, LOSSY)], ids=["clean", "lossy"]
)
def test_erasing_is_seen_to_have_happened(kind: type, impairment: Impairment | None) -> None:
    harness = LogHarness(kind, impairment)
    assert harness.run(harness.client.erase(harness.network.now)).error is None
    assert harness.store.contents == {}


def test_erasing_that_does_nothing_is_a_typed_error() -> None:
    harness = LogHarness()
    harness.store.erase = lambda: None
    error = harness.run(harness.client.erase(harness.network.now)).error
    assert isinstance(error, RemoteDenied)
    assert "7 logs remain" in str(error)


def test_a_slow_radio_is_used_well() -> None:
    harness = LogHarness(radio=(radio := HalfDuplexRadio()), bandwidth=5760.0)
    harness.download(7)
    minimum = 30_000 / 90 * 102 / 5760
    assert harness.network.now - START < 1.25 * minimum
    assert radio.overflowed == 0


@pytest.mark.parametrize("kind", [ArduPilotLogs, PX4Logs])
def test_a_sender_that_overruns_a_radio_is_slowed_by_smaller_windows(kind: type) -> None:
    harness = LogHarness(kind, radio=(radio := HalfDuplexRadio()), sizes=[100_000])
    (entry,) = harness.list().result()
    assert harness.download(entry).result() == harness.contents[entry.id]
    assert harness.network.now - START < 1.4 * 100_000 / 90 * 102 / 5760
    assert radio.overflowed < 100


def test_on_a_link_that_loses_much_windows_stay_large() -> None:
    harness = LogHarness(impairment=LOSSY, sizes=[300_000])
    harness.download(1)
    assert harness.network.now - START < 8
    assert len(harness.received(common.LogRequestData)) < 40


@pytest.mark.parametrize("seed", range(30))
def test_garbage_never_raises(seed: int) -> None:
    for begin in (
        lambda client: client.list_logs(START),
        lambda client: client.download(LogEntry(0, 0, 100), START),
        lambda client: client.erase(START),
    ):
        client = LogClient(GROUND, VEHICLE)
        begin(client)
        feed_random_messages(client, [common.LogEntry, common.LogData], seed)


def growing(harness: LogHarness, replace: bool) -> None:
    """The last log is written on, or another takes its id, while it is fetched."""
    number = max(harness.store.contents)

    def change() -> None:
        kept = Random(9).randbytes(30_000) if replace else harness.store.contents[number]
        harness.store.contents[number] = kept + bytes(50_000)
        harness.store.times[number] = 1_700_000_000

    harness.network.at(0.2, change)


def test_a_log_that_is_being_written_can_be_download() -> None:
    harness = LogHarness(impairment=Impairment(latency=0.02, bandwidth=20_000.0, queue=1 << 20))
    growing(harness, replace=False)
    download = harness.download(max(harness.store.contents))
    content = download.result()
    assert len(content) >= 30_000
    assert harness.store.contents[max(harness.store.contents)].startswith(content)


def test_a_larger_log_in_its_place_is_not_taken_for_it() -> None:
    harness = LogHarness(impairment=Impairment(latency=0.02, bandwidth=20_000.0, queue=1 << 20))
    growing(harness, replace=True)
    with pytest.raises(RemoteProtocolError, match="another log"):
        harness.download(max(harness.store.contents)).result()


def test_a_log_that_is_closed_while_it_is_read_may_be_dated_back() -> None:
    """ArduPilot dates a log by its clock while it writes it, then by its file."""
    harness = LogHarness(impairment=Impairment(latency=0.02, bandwidth=20_000.0, queue=1 << 20))
    number = max(harness.store.contents)

    def close() -> None:
        harness.store.times[number] = 1_500_000_000
        harness.store.contents[number + 1] = bytes(100)
        harness.store.times[number + 1] = 1_700_000_000

    harness.network.at(0.2, close)
    assert harness.download(number).result() == harness.store.contents[number]
