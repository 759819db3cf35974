"""Onboard logs: start and end, listing, capacity, failures, recovery."""

from __future__ import annotations

from errno import ENOSPC

import pytest

from mavstack.errors import LocalProtocolError
from mavstack.services.ftp import MemoryStore
from mavstack.sim.storage import DataflashLogs, UlogLogs, file_store
from mavstack.sim.storage.flight_logs import FLUSH_SIZE, MIN_LOG_CAPACITY
from tests.sim.storage.samples import (
    BOOT,
    SECOND,
    content,
    fly,
    log_start,
    paths,
    read_dataflash,
    read_ulog,
    sample,
    values_of,
)


@pytest.fixture(params=[DataflashLogs, UlogLogs], ids=["ardupilot", "px4"])
def log_class(request):
    return request.param


@pytest.fixture(params=["memory", "folder"])
def store(request, tmp_path):
    return file_store(None if request.param == "memory" else tmp_path / "vehicle")


@pytest.fixture
def logs(log_class, store):
    logs = log_class(store, log_start)
    yield logs
    logs.end()


class TestFlights:
    def test_no_log_without_a_flight(self, logs) -> None:
        assert logs.logs() == []
        assert not logs.writing
        logs.write(sample())
        logs.text(0, 6, "no log is open")
        logs.mode(0, 1)
        logs.armed(0, True)
        logs.event(0, 1)
        logs.error(0, 1, 1)
        logs.parameter(0, "X", 1)
        logs.home(0, 0.0, 0.0, 0.0)
        logs.end()
        assert logs.logs() == []
        with pytest.raises(FileNotFoundError):
            logs.read(1, 0, 1)

    def test_each_flight_has_a_log(self, logs, log_class, tmp_path) -> None:
        fly(logs, 5 * SECOND)
        fly(logs, 65 * SECOND, samples=7)
        first, second = logs.logs()
        assert (first.id, second.id) == ((1, 2) if log_class is DataflashLogs else (0, 1))
        assert (first.time_utc, second.time_utc) == (int(BOOT) + 5, int(BOOT) + 65)
        for log, number in ((first, 20), (second, 7)):
            data = content(logs, log.id)
            assert len(data) == log.size
            if log_class is DataflashLogs:
                assert len(read_dataflash(data, tmp_path)["ATT"]) == number
            else:
                assert len(values_of(read_ulog(data), "vehicle_attitude")["timestamp"]) == number

    def test_open_log_can_be_read(self, logs, log_class, tmp_path) -> None:
        logs.begin(0)
        logs.write(sample(0))
        (early,) = logs.logs()
        early_content = logs.read(early.id, 0, early.size)
        for step in range(1, 50):
            logs.write(sample(step * 100_000))
        (later,) = logs.logs()
        assert later.size > early.size
        assert later.may_be(early)
        later_content = logs.read(later.id, 0, later.size)
        assert later_content.startswith(early_content)
        assert len(later_content) == later.size
        if log_class is DataflashLogs:
            assert len(read_dataflash(later_content, tmp_path)["ATT"]) == 50
        assert logs.writing

    def test_status_text_is_logged(self, logs, log_class, tmp_path) -> None:
        logs.begin(0)
        logs.text(1, 4, "Something happened")
        logs.end()
        data = content(logs, logs.logs()[0].id)
        if log_class is DataflashLogs:
            assert read_dataflash(data, tmp_path)["MSG"][-1]["Message"] == "Something happened"
        else:
            assert read_ulog(data).logged_messages[-1].message == "Something happened"

    def test_begin_ends_the_open_log(self, logs) -> None:
        logs.begin(0)
        logs.begin(SECOND)
        assert len(logs.logs()) == 2

    def test_buffer_is_small(self, logs, store) -> None:
        logs.begin(0)
        for step in range(100):
            logs.write(sample(step * 100_000))
        log_path = next(path for path in paths(store) if path.upper().endswith(("BIN", "ULG")))
        file = store.open_file(log_path)
        stored_size = file.size()
        file.close()
        assert 0 <= logs.logs()[0].size - stored_size < 2 * FLUSH_SIZE

    def test_reading_a_range(self, logs) -> None:
        fly(logs, 0)
        (log,) = logs.logs()
        whole = logs.read(log.id, 0, log.size)
        pieces = [logs.read(log.id, at, 90) for at in range(0, log.size, 90)]
        assert b"".join(pieces) == whole
        assert logs.read(log.id, log.size, 90) == b""


class TestNames:
    def test_ardupilot(self) -> None:
        store = MemoryStore()
        logs = DataflashLogs(store, log_start)
        for flight in range(3):
            fly(logs, flight * SECOND, samples=1)
        assert paths(store) == [
            "/APM/LOGS/00000001.BIN",
            "/APM/LOGS/00000002.BIN",
            "/APM/LOGS/00000003.BIN",
            "/APM/LOGS/LASTLOG.TXT",
        ]
        assert store["/APM/LOGS/LASTLOG.TXT"] == b"3\r\n"

    def test_px4(self) -> None:
        store = MemoryStore()
        logs = UlogLogs(store, log_start)
        for begin_us in (0, 300_000, 7200 * SECOND):
            fly(logs, begin_us, samples=1)
        assert paths(store) == [
            "/fs/microsd/log/2023-11-14/22_13_20.ulg",
            "/fs/microsd/log/2023-11-14/22_13_21.ulg",
            "/fs/microsd/log/2023-11-15/00_13_20.ulg",
        ]

    def test_ardupilot_numbers_wrap_to_1(self) -> None:
        store = MemoryStore({"/APM/LOGS/LASTLOG.TXT": b"499\r\n", "/APM/LOGS/00000001.BIN": b"old"})
        logs = DataflashLogs(store, log_start)
        fly(logs, 0, samples=1)
        fly(logs, SECOND, samples=1)
        found = {log.id: log.size for log in logs.logs()}
        assert set(found) == {1, 500}
        assert found[1] > 3

    @pytest.mark.parametrize("text", [b"", b"x", b"-4", b"\xff\xfe", b"\xc2\xb2"])
    def test_invalid_last_number_is_recovered_from_the_files(self, text) -> None:
        store = MemoryStore({"/APM/LOGS/LASTLOG.TXT": text, "/APM/LOGS/00000041.BIN": b"old"})
        logs = DataflashLogs(store, log_start)
        fly(logs, 0, samples=1)
        assert [log.id for log in logs.logs()] == [41, 42]

    def test_huge_last_number(self) -> None:
        store = MemoryStore({"/APM/LOGS/LASTLOG.TXT": b"99999999"})
        logs = DataflashLogs(store, log_start)
        fly(logs, 0, samples=1)
        assert all(1 <= log.id <= 500 for log in logs.logs())

    def test_other_files_are_not_listed(self, log_class) -> None:
        store = MemoryStore(
            {
                "/APM/LOGS/notes.txt": b"x",
                "/APM/LOGS/0.BIN": b"x",
                "/APM/LOGS/700.BIN": b"x",
                "/fs/microsd/log/2023-11-14/x.ulg": b"x",
                "/fs/microsd/log/today/00_00_00.ulg": b"x",
                "/fs/microsd/log/loose.ulg": b"x",
            }
        )
        assert log_class(store, log_start).logs() == []

    @pytest.mark.parametrize("boot", [-1e12, 0.0, 1e18])
    def test_any_boot_time_gives_a_path(self, log_class, boot) -> None:
        logs = log_class(MemoryStore(), lambda: log_start(boot=boot))
        fly(logs, 0, samples=1)
        assert len(logs.logs()) == 1

    def test_invalid_date(self) -> None:
        store = MemoryStore({"/fs/microsd/log/2023-99-99/00_00_00.ulg": b"x"})
        assert [log.time_utc for log in UlogLogs(store, log_start).logs()] == [0]


class TestCapacity:
    def new_logs(self, log_class, store):
        return log_class(store, log_start, capacity=MIN_LOG_CAPACITY)

    def test_oldest_logs_are_removed_first(self, log_class) -> None:
        store = MemoryStore()
        logs = self.new_logs(log_class, store)
        for flight in range(60):
            fly(logs, flight * 10 * SECOND, samples=60)
        found = logs.logs()
        assert sum(log.size for log in found) <= MIN_LOG_CAPACITY + FLUSH_SIZE
        assert 2 < len(found) < 60
        assert found[-1].time_utc == int(BOOT) + 590
        assert [log.id for log in found] == list(range(found[0].id, found[-1].id + 1))

    def test_long_flight_keeps_its_last_part(self, log_class, tmp_path) -> None:
        store = MemoryStore()
        logs = self.new_logs(log_class, store)
        logs.begin(0)
        for step in range(5000):
            logs.write(sample(step * 100_000))
            if step % 500 == 0:
                assert sum(log.size for log in logs.logs()) <= MIN_LOG_CAPACITY + 2 * FLUSH_SIZE
        logs.end()
        found = logs.logs()
        assert sum(log.size for log in found) >= MIN_LOG_CAPACITY // 3
        times = []
        for log in found:
            data = content(logs, log.id)
            if log_class is DataflashLogs:
                times += [message["TimeUS"] for message in read_dataflash(data, tmp_path)["ATT"]]
            else:
                times += values_of(read_ulog(data), "vehicle_attitude")["timestamp"]
        assert times == list(range(times[0], 5000 * 100_000, 100_000)), "no sample is lost"

    def test_oldest_log_after_numbers_wrap(self) -> None:
        store = MemoryStore({"/APM/LOGS/LASTLOG.TXT": b"498\r\n"})
        logs = self.new_logs(DataflashLogs, store)
        for flight in range(60):
            fly(logs, flight * 10 * SECOND, samples=60)
        ids = [log.id for log in logs.logs()]
        assert max(ids) == 58
        assert 500 not in ids
        assert min(ids) > 30

    def test_too_small_capacity_is_refused(self, log_class) -> None:
        with pytest.raises(LocalProtocolError):
            log_class(MemoryStore(), log_start, capacity=MIN_LOG_CAPACITY - 1)


class TestFailures:
    def test_full_store_ends_the_log(self, log_class) -> None:
        store = MemoryStore(capacity=60_000)
        logs = log_class(store, log_start)
        logs.begin(0)
        assert logs.writing
        for step in range(1000):
            logs.write(sample(step * 100_000))
        assert not logs.writing
        assert logs.failed
        (log,) = logs.logs()
        assert 50_000 < log.size <= 60_000
        store.capacity = 1 << 20
        logs.begin(0)
        assert logs.writing
        assert not logs.failed

    def test_store_that_refuses_writes(self, log_class) -> None:
        class Broken(MemoryStore):
            def open_file(self, path: str, *, write: bool = False, truncate: bool = False):
                raise OSError(ENOSPC, "no card")

        logs = log_class(Broken(), log_start)
        fly(logs, 0)
        assert logs.failed
        assert logs.logs() == []

    def test_removed_log_is_not_listed(self, logs, store) -> None:
        fly(logs, 0)
        fly(logs, 10 * SECOND)
        first, second = logs.logs()
        removed = next(path for path in sorted(paths(store)) if path.upper().endswith(("BIN", "ULG")))
        store.remove(removed)
        assert logs.logs() == [second]
        with pytest.raises(FileNotFoundError):
            logs.read(first.id, 0, 1)

    def test_open_log_may_be_removed(self, log_class) -> None:
        store = MemoryStore()
        logs = log_class(store, log_start)
        logs.begin(0)
        store.remove(next(path for path in paths(store) if path.upper().endswith(("BIN", "ULG"))))
        for step in range(100):
            logs.write(sample(step * 100_000))
        assert logs.logs() == []
        logs.end()
        fly(logs, 60 * SECOND)
        assert len(logs.logs()) == 1

    def test_erase(self, logs, store, log_class) -> None:
        fly(logs, 0)
        fly(logs, 10 * SECOND)
        logs.read(logs.logs()[0].id, 0, 9)
        logs.erase()
        assert logs.logs() == []
        assert paths(store) == []
        fly(logs, 20 * SECOND)
        assert [log.id for log in logs.logs()] == [1 if log_class is DataflashLogs else 0]

    def test_erase_with_an_open_log_starts_a_new_one(self, logs) -> None:
        logs.begin(0)
        logs.write(sample(30 * SECOND))
        logs.erase()
        assert logs.writing
        (log,) = logs.logs()
        assert log.time_utc == int(BOOT) + 30


class TestFolder:
    def test_logs_are_found_again(self, log_class, tmp_path) -> None:
        logs = log_class(file_store(tmp_path), log_start)
        fly(logs, 0)
        fly(logs, 10 * SECOND)
        before = {log.id: content(logs, log.id) for log in logs.logs()}
        again = log_class(file_store(tmp_path), log_start)
        assert {log.id: content(again, log.id) for log in again.logs()} == before
        fly(again, 20 * SECOND)
        assert [log.id for log in again.logs()] == [*before, max(before) + 1]

    def test_unfinished_log_is_kept(self, log_class, tmp_path) -> None:
        logs = log_class(file_store(tmp_path), log_start)
        logs.begin(0)
        for step in range(200):
            logs.write(sample(step * 100_000))
        size = logs.logs()[0].size
        again = log_class(file_store(tmp_path), log_start)
        assert [log.size for log in again.logs()] == [size]
        logs.end()
