"""Binary DataFlash logs: tables, times, pieces, damage and hostile files."""

from __future__ import annotations

import random

import numpy as np
import pytest

from mavstack._core import DataFlashIndex
from mavstack.errors import LogError, UnknownMessageError
from mavstack.logs import open_log
from mavstack.logs.dataflash import DataFlashLog

from .writer import LogWriter, flight

BOOT = 1_700_000_000_000_000


@pytest.fixture
def path(tmp_path):
    return tmp_path / "log.BIN"


def opened(path, log):
    path.write_bytes(bytes(log.data if isinstance(log, LogWriter) else log))
    return open_log(path)


def columns(tables):
    """Return the columns of several tables one after the other, as bytes (padding is left out)."""
    rows = np.concatenate([np.asarray(table) for table in tables])
    return {name: rows[name].tobytes() for name in rows.dtype.names}


def test_the_content_decides_the_format(tmp_path):
    log = opened(tmp_path / "flight.tlog", flight(records=20))
    assert isinstance(log, DataFlashLog)
    assert log.format == "dataflash"


def test_a_damaged_beginning_does_not_hide_the_format(path):
    data = bytearray(flight(records=100).data)
    data[:40] = b"\0" * 40
    log = opened(path, data)
    assert log.format == "dataflash"
    # The definition of FMT itself, which every reader knows, is lost.
    assert log.skipped.bad_bytes == 89
    assert "ATT" in log


def test_times_are_utc_by_gps(path):
    log = opened(path, flight(records=400))
    assert (log.time_base.kind, log.time_base.offset_us) == ("utc", BOOT)
    table = log["ATT"]
    assert (table["_time"].astype(np.int64) == BOOT + table["TimeUS"].astype(np.int64)).all()
    assert log.times("ATT", "boot").tolist() == (table["TimeUS"] / 1e6).tolist()
    assert (log["FMT"]["_time"] == log.start).all(), (
        "definitions have the time of the first record after them"
    )
    assert log.start == np.datetime64(BOOT + 900, "us")
    assert log.duration == pytest.approx((2000 + 399 * 2500 - 900) / 1e6)


def test_without_gps_only_the_time_since_boot_is_known(path):
    writer = LogWriter()
    writer.write("MSG", 5_000_000, "a")
    writer.gps(5_500_000, -5_500_000 + 315_964_800_000_000 - 18_000_000, status=1)
    writer.write("MSG", 6_000_000, "b")
    log = opened(path, writer)
    assert log.time_base.kind == "boot"
    assert log.start is None
    assert np.isnat(log["MSG"]["_time"]).all()
    assert log.times("MSG").tolist() == [5.0, 6.0]


def test_instances_come_from_the_unit(path):
    writer = LogWriter()
    for number in range(6):
        writer.write("IMU", 1000 + number, number % 3, *[float(number)] * 6)
        writer.write("BAT", 1000 + number, 1, 12.5, 900, -50)
    log = opened(path, writer)
    assert log["IMU"]["_instance"].tolist() == [0, 1, 2, 0, 1, 2]
    assert log["IMU[2]"]["GyrX"].tolist() == [2.0, 5.0]
    assert log.select("IMU", instance=1).counts == {"IMU": 2}
    assert log.schema("BAT").instance_field == "_instance"
    with pytest.raises(UnknownMessageError, match="instances: 0, 1, 2"):
        log["IMU[7]"]


def test_values_are_scaled_by_their_character_or_on_request(path):
    writer = LogWriter()
    writer.write("BAT", 1000, 1, 12.5, 905, -1234)
    log = opened(path, writer)
    assert log["BAT"]["Curr"].tolist() == [-12.34]
    assert log["BAT"]["Res"].tolist() == [905]
    assert log["BAT"].scaled("Res").tolist() == [90.5]
    assert log["BAT"].scaled("Curr").tolist() == [-12.34]
    assert (log.schema("BAT")["Res"].unit, log.schema("BAT")["Curr"].unit) == ("%", "A")


def test_a_type_with_other_fields_from_some_place_on_is_another_table(path):
    writer = LogWriter()
    writer.write("MODE", 1, 5, 5, 1)
    writer.define(6, "MODE", "QMB", "TimeUS,Mode,ModeNum")
    writer.write("MODE", 2, 6, 6)
    writer.define(60, "MODE", "QMB", "TimeUS,Mode,ModeNum")
    writer.write("MODE", 3, 7, 7)
    log = opened(path, writer)
    assert log["MODE"]["TimeUS"].tolist() == [1]
    assert log["MODE_2"]["TimeUS"].tolist() == [2, 3], "equal definitions share a table, in file order"
    assert "Rsn" not in log.schema("MODE_2")


def test_pieces_make_the_whole(path):
    log = opened(path, flight(records=1500))
    for size in (1000, 30_000, 1 << 20):
        pieces = {}
        for window in log.windows(size):
            for name, table in window.items():
                pieces.setdefault(name, []).append(table)
        assert pieces.keys() == log.keys()
        for name in log:
            assert columns(pieces[name]) == columns([log[name]]), name
    some = list(log.windows(30_000, ["ATT", "absent"]))
    assert {name for window in some for name in window} == {"ATT"}
    assert list(some[0]["ATT"].schema) == list(log.schema("ATT"))


def test_records_come_in_file_order(path):
    log = opened(path, flight(records=200))
    records = list(log.records())
    assert len(records) == sum(log.counts.values())
    assert [record.name for record in records[:4]] == ["FMT"] * 4
    times = [record["TimeUS"] for record in records if "TimeUS" in record]
    assert times == sorted(times)
    assert [record["Message"] for record in log.records("MSG")] == ["ArduCopter V4.5.7 (2a3dc4b7)"]


def test_threads_do_not_change_the_result(path):
    path.write_bytes(bytes(flight(records=3000).data) * 3)
    one, many = DataFlashLog(path, threads=1), DataFlashLog(path, threads=5)
    assert one.counts == many.counts
    one.load()
    many.load()
    assert all(columns([one[name]]) == columns([many[name]]) for name in one)


def test_bytes_of_files_are_kept(path):
    writer = LogWriter()
    content = b"a\0b\xff" + bytes(59) + b"z"
    writer.write("FILE", "param.pck", 0, 64, content)
    assert bytes(opened(path, writer)["FILE"]["Data"][0]) == content


def test_arrays_are_columns_of_two_dimensions(path):
    writer = LogWriter()
    values = np.arange(-16, 16, dtype="<i2")
    writer.write("ISBD", 1, 7, values.tobytes())
    table = opened(path, writer)["ISBD"]
    assert table["x"].shape == (1, 32)
    assert table["x[3]"].tolist() == [-13]


def test_damage_is_counted(path):
    log = flight(records=300)
    log.data[len(log.data) - 500 : len(log.data) - 400] = b"\0" * 100
    log.data += b"\xa3\x95\x63abc"
    log.write("MSG", 10**7, "complete")
    log.write("MSG", 10**7, "cut off")
    del log.data[-7:]
    skipped = opened(path, log).skipped
    assert skipped.bad_bytes > 60
    assert skipped.truncated_bytes == 3 + 8 + 64 - 7
    assert skipped.unknown == {0x63: 1}
    assert "unknown id 99" in skipped.describe()
    assert skipped.to_dict()["total"] == skipped.total


def test_a_definition_with_an_unknown_character_keeps_the_fields_before_it(path):
    writer = LogWriter()
    writer.define(50, "NEW", "QB?f", "TimeUS,A,B,C")
    writer.data += b"\xa3\x95\x32" + (5).to_bytes(8, "little") + b"\x07\x01" + bytes(4)
    log = opened(path, writer)
    assert log["NEW"].dtype.names == ("_time", "_instance", "TimeUS", "A")
    assert log["NEW"]["A"].tolist() == [7]
    assert log.skipped.other == {"fields of unknown format": 2}


@pytest.mark.parametrize("labels", ["TimeUS", "TimeUS,A,A,A", "TimeUS,,_time,B", "", "TimeUS,A,B,C,D,E"])
def test_odd_labels_give_distinct_columns(path, labels):
    writer = LogWriter()
    writer.define(50, "ODD", "QBBB", labels)
    writer.write("ODD", 1, 2, 3, 4)
    names = [name for name in opened(path, writer)["ODD"].dtype.names if name != "_boot_us"]
    assert len(set(names)) == len(names) == 2 + min(4, labels.count(",") + bool(labels))


@pytest.mark.parametrize("seed", range(15))
def test_hostile_files_never_crash(path, seed):
    rng = random.Random(seed)
    data = bytearray(flight(seed, records=60).data)
    for _ in range(rng.randrange(200)):
        data[rng.randrange(len(data))] = rng.randrange(256)
    log = opened(path, b"\xa3\x95\x80" + data[rng.randrange(300) : rng.randrange(1000, len(data))])
    log.load()
    list(log.records())
    assert isinstance(log.info, dict)
    assert isinstance(log.texts, list)
    assert isinstance(log.parameters, dict)
    assert (log.time_span, log.skipped.describe(), [log.schema(name) for name in log]) is not None


def test_a_file_with_a_header_alone_is_an_empty_log(path):
    log = opened(path, b"\xa3\x95\x80")
    assert (len(log), log.skipped.truncated_bytes, log.duration, log.time_span) == (0, 3, 0.0, None)


def test_a_rewritten_file_is_refused(path):
    log = opened(path, flight(records=50))
    writer = LogWriter()
    writer.data += bytes(len(flight(records=50).data) - len(writer.data))
    with path.open("r+b") as file:
        file.write(writer.data)
        with pytest.raises(LogError, match="rewritten"):
            log.load()


def test_indexed_parts_are_reported(path):
    data = bytes(flight(records=50).data)
    parts = []
    DataFlashIndex(data, step=1 << 21, done=lambda start, end: parts.append((start, end)))
    assert parts == [(0, len(data))]
    with pytest.raises(ZeroDivisionError):
        DataFlashIndex(data, done=lambda start, end: 1 // start)
