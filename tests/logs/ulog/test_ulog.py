"""ULog: tables, instances, times, facts, windows and damage."""

from __future__ import annotations

import os

import numpy as np
import pytest

from mavstack.errors import LogError, UnknownMessageError
from mavstack.logs import open_log
from mavstack.logs.ulog import ULog, ulog
from tests.logs.ulog.ulog_files import BOOT_UTC_US, START_US, UlogBuilder, add_samples, definitions, flight


@pytest.fixture
def log(written):
    return ULog(written(flight(200)))


def test_a_log_is_recognised_by_its_content(written):
    path = written(flight(1))
    log = open_log(path.rename(path.with_suffix(".tlog")))
    assert (type(log), log.format) == (ULog, "ulog")
    assert log.counts == {"attitude": 1}


def test_tables_have_the_fields_of_the_topic(log):
    table = log["esc_status"]
    assert table.dtype.names == (
        "_time", "_instance", "timestamp", "counter", "count",
        "esc[0].errors", "esc[0].rpm", "esc[0].state", "esc[1].errors", "esc[1].rpm", "esc[1].state",
    )  # fmt: skip
    assert table["esc[0].rpm"].tolist()[0] == [1.5, 2.0]
    assert table["esc[1].rpm[1]"].tolist()[0] == 4.0
    assert log["attitude"]["q"].shape == (200, 4)
    assert log["attitude"]["flags"].dtype == np.bool_
    assert log["text"]["name"].tolist()[:2] == [b"ab", b"longname"]
    assert log["numbers"]["a"].tolist()[0] == -(2**62)


def test_instances(log):
    table = log["esc_status"]
    assert log.instances["esc_status"] == {0: 25, 1: 25}
    assert table["_instance"].tolist() == [0, 1] * 25, "rows are in the order of the file"
    assert log["esc_status[1]"]["counter"].tolist() == table["counter"].tolist()[1::2]
    assert len(log.select("esc_status", instance=0)["esc_status"]) == 25
    assert log["numbers[3]"]["b"].tolist()[0] == -(2**31)
    with pytest.raises(UnknownMessageError, match="contains no esc_status\\[2\\]; instances: 0, 1"):
        log["esc_status[2]"]
    with pytest.raises(UnknownMessageError, match="contains no ATTITUDE; did you mean attitude"):
        log["ATTITUDE"]


def test_times_are_utc_with_satellite_navigation(log):
    base = log.time_base
    assert (base.kind, base.source) == ("utc", "vehicle_gps_position.time_utc_usec")
    assert base.offset_us == pytest.approx(BOOT_UTC_US, abs=2)
    assert base.uncertainty_us < 3
    boot = log["attitude"]["timestamp"].astype(np.int64)
    assert (log["attitude"]["_time"].astype(np.int64) - boot == base.offset_us).all()
    assert (log.times("attitude", "boot") == boot / 1e6).all()
    assert log.start == log["attitude"]["_time"][0]
    assert log.duration == pytest.approx(199 * 0.004)


def test_times_without_satellite_navigation(written):
    log = ULog(written(flight(10)))
    assert log.time_base.kind == "boot"
    assert np.isnat(log["attitude"]["_time"]).all()
    assert (log.start, log.duration) == (None, pytest.approx(9 * 0.004))
    assert log.times("attitude").tolist() == log.times("attitude", "boot").tolist()
    assert log.times("attitude")[0] == START_US / 1e6
    with pytest.raises(LogError, match="utc time of attitude is not known"):
        log.times("attitude", "utc")


def test_times_of_the_autopilots_own_clock(written):
    builder = definitions().value("I", "uint64_t boot_time_utc_us", BOOT_UTC_US.to_bytes(8, "little"))
    log = ULog(written(add_samples(builder, 3).data))
    assert (log.time_base.offset_us, log.time_base.uncertainty_us) == (BOOT_UTC_US, None)
    assert log["attitude"]["_time"][0] == np.datetime64(BOOT_UTC_US + START_US, "us")


def test_facts(log):
    facts = {"autopilot": "PX4", "hardware": "PX4_V5", "firmware_version": "1.14.3", "key": "010203"}
    assert facts.items() <= log.info.items()
    assert not log.info.keys() & {"sys_name", "ver_sw_release"}, "each fact has one name"
    assert log.parameters == {"MAV_TYPE": 2, "MAV_SYS_ID": 7, "MC_P": 0.5, "COUNT": 3, "NEW": 20}
    assert [(change.name, change.before, change.value) for change in log.parameter_changes][:4] == [
        ("MC_P", 0.5, 2.5),
        ("NEW", None, 20),
        ("MC_P", 2.5, 10.0),
        ("NEW", 20, 80),
    ]
    assert log.default_parameters == {"system": {"MC_P": 0.25, "COUNT": 4}, "configuration": {"COUNT": 4}}
    assert [(vehicle.vehicle_type, vehicle.autopilot) for vehicle in log.vehicles.values()] == [
        ("QUADROTOR", "PX4")
    ]
    assert log.vehicles.keys() == {7}
    assert [(text.severity, text.text) for text in log.texts][:3] == [
        (4, "text 20"),
        (4, "tagged"),
        (0, "text 80"),
    ]
    assert log.texts[0].time == np.datetime64(log.time_base.offset_us + START_US + 80_000, "us")
    assert [dropout.duration for dropout in log.dropouts] == [0.02, 0.08, 0.14]


def test_a_view_has_the_texts_of_its_time(log):
    view = log.select(start=0.3, end=0.5)
    assert [text.text for text in view.texts] == ["text 80", "tagged"]
    assert [change.value for change in view.parameter_changes] == [10.0, 80]


@pytest.mark.parametrize("size", [100, 3000, 1 << 20])
def test_windows_give_the_rows_of_the_tables(log, size):
    pieces: dict[str, list[bytes]] = {}
    progress = []
    for tables in log.windows(size, progress=lambda *sizes: progress.append(sizes)):
        for name, table in tables.items():
            pieces.setdefault(name, []).append(table.tobytes())
    assert {name: b"".join(parts) for name, parts in pieces.items()} == {
        name: log[name].tobytes() for name in log
    }
    assert progress == sorted(progress)
    assert progress[-1] == (log.size, log.size)


def test_windows_of_some_tables(log):
    assert {name for tables in log.windows(5000, ["text", "absent"]) for name in tables} == {"text"}


def test_a_large_file_is_indexed_without_positions(written, monkeypatch):
    path = written(flight(60))
    expected = ULog(path)
    monkeypatch.setattr(ulog, "_MAX_STORED", 0)
    log = ULog(path)
    assert not log._index.has_positions
    assert (log.counts, log.time_base) == (expected.counts, expected.time_base)
    assert not log._index.has_positions, "the clock is read piece by piece"
    assert log["esc_status"].tobytes() == expected["esc_status"].tobytes()


def test_a_file_that_another_process_opens_meanwhile(written):
    path = written(flight(60))
    log, expected = ULog(path), ULog(path)
    windows = log.windows(2000)
    first = next(windows)
    with path.open("r+b"):
        rest = list(windows)
        table = log["attitude"]
    joined = b"".join(tables["attitude"].tobytes() for tables in [first, *rest] if "attitude" in tables)
    assert joined == table.tobytes() == expected["attitude"].tobytes()


def test_a_file_that_is_rewritten_meanwhile(written):
    path = written(flight(60))
    log = ULog(path)
    content = path.read_bytes()
    path.write_bytes(content[:300] + bytes(len(content) - 300))
    with (
        path.open("r+b"),
        pytest.raises(LogError, match=r"it was rewritten since it was opened; open it again"),
    ):
        log["attitude"]


def test_a_file_that_is_truncated_meanwhile(log):
    os.truncate(log.path, 100)
    with pytest.raises(LogError, match="truncated since it was opened"):
        log["attitude"]


@pytest.mark.parametrize(
    ("data", "problem"),
    [
        (b"", "it has 0 bytes, the header of a ULog has 16"),
        (b"ULog\x01\x12\x35\x01", "it has 8 bytes"),
        (b"FD: no log at all", "it does not begin like a ULog"),
        (
            bytes(UlogBuilder().flags(incompatible=6).data),
            r"it uses features of ULog that are not supported \(incompatible flags 0600000000000000\)",
        ),
    ],
)
def test_files_that_cannot_be_read(written, data, problem):
    path = written(data)
    with pytest.raises(LogError, match=f"^cannot open {path}: {problem}"):
        ULog(path)


def test_damage_is_counted(written):
    builder = add_samples(definitions(), 20)
    builder.data += bytes(100)
    builder.value("I", "uint32_t short", b"\0").value("P", "char[1] text", b"x")
    log = ULog(written(add_samples(builder, 20, first=20).data + b"\xff\xffD\0"))
    assert log.counts["attitude"] == 40
    assert (log.skipped.bad_bytes, log.skipped.bad_records, log.skipped.truncated_bytes) == (100, 2, 4)
    assert log.skipped.total == 106
    assert log.skipped.describe() == "100 bad bytes, 2 damaged records, 4 bytes of a truncated record"


def test_a_log_without_records(written):
    log = ULog(written(UlogBuilder().data))
    assert (dict(log), log.start, log.duration, log.texts, log.parameters) == ({}, None, 0.0, [], {})
    assert (list(log.windows()), log.skipped.total) == ([{}], 0)
