"""DataFlash logs, compared with pymavlink's reader: row for row, value for value.

pymavlink keeps the last definition of a type number only, accepts whatever follows a header, and ends at a
type without a definition. The tests with damage state each difference.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from mavstack.logs import open_log

from .reference import assert_equal_rows, pymavlink_rows
from .writer import TYPES, LogWriter, flight

BOOT = 1_700_000_000_000_000


def written(tmp_path, data):
    path = tmp_path / "log.BIN"
    path.write_bytes(bytes(data))
    return path


def assert_same(path):
    log, theirs = open_log(path), pymavlink_rows(path)
    assert dict(log.counts) == {name: len(rows) for name, rows in theirs.items()}
    for name, rows in theirs.items():
        assert_equal_rows(log, name, rows)
    return log, theirs


@pytest.mark.parametrize("seed", range(4))
def test_pymavlink_reads_the_same_values(tmp_path, seed):
    log, _ = assert_same(written(tmp_path, flight(seed, records=800).data))
    assert not log.skipped
    assert {kind[1] for kind in TYPES} <= log.keys()


def test_pymavlink_has_the_same_times(tmp_path):
    log, theirs = assert_same(written(tmp_path, flight(records=400).data))
    for name in ("IMU", "GPS", "ATT", "BAT"):
        times = [time for _, time in theirs[name]]
        np.testing.assert_allclose(log.times(name, "utc"), times, rtol=0, atol=2e-3)


def test_pymavlink_has_the_same_units(tmp_path):
    from pymavlink import DFReader

    path = written(tmp_path, flight(records=200).data)
    log, reader = open_log(path), DFReader.DFReader_binary(str(path))
    units = {reader.formats[number].name: reader.formats[number].units for number in reader.formats}
    reader.close()
    assert log.schema("BAT")["Volt"].unit == units["BAT"][2] == "V"
    assert log.schema("ATT")["Roll"].unit == units["ATT"][2] == "deg"
    # pymavlink puts the multiplier into the unit, here it is beside the unit.
    assert units["BAT"][3] == "d%"
    assert (log.schema("BAT")["Res"].unit, log.schema("BAT")["Res"].multiplier) == ("%", 0.1)


def test_junk_between_records_is_skipped_by_both(tmp_path):
    data = bytearray(flight(records=600).data)
    start = data.find(b"\xa3\x95\x02", len(data) // 2)
    data[start:start] = b"\0" * 700
    log, _ = assert_same(written(tmp_path, data))
    assert (log.skipped.bad_bytes, log.skipped.bad_records) == (700, 0)


def test_a_record_that_lost_bytes_costs_pymavlink_the_next_one_too(tmp_path):
    log = LogWriter()
    for number in range(300):
        log.write("IMU", 1000 * number, 0, *[float(number)] * 6)
    size = log.structs["IMU"].size + 3
    start = len(log.data) - 100 * size
    del log.data[start + 20 : start + 30]
    path = written(tmp_path, log.data)
    ours, theirs = open_log(path), pymavlink_rows(path)["IMU"]
    # It takes ten bytes of the next record for the lost ones: a row of wrong values, and record 201 is lost.
    assert [row["TimeUS"] for row, _ in theirs[199:202]] == [199_000, 200_000, 202_000]
    assert theirs[200][0]["AccZ"] != 200.0
    assert ours["IMU"]["TimeUS"].tolist() == [1000 * number for number in range(300) if number != 200]
    assert np.array_equal(ours["IMU"]["AccZ"], ours["IMU"]["TimeUS"] / 1000)
    assert (ours.skipped.bad_records, ours.skipped.bad_bytes) == (1, size - 10)


def test_pymavlink_takes_false_headers_in_junk_for_records(tmp_path):
    log = LogWriter()
    for number in range(200):
        log.write("IMU", 1000 * number, 0, *[1.0] * 6)
    log.data += b"\x01\xa3\x95\x02" + b"\x07" * 600
    for number in range(200, 300):
        log.write("IMU", 1000 * number, 0, *[1.0] * 6)
    path = written(tmp_path, log.data)
    ours, theirs = open_log(path), pymavlink_rows(path)["IMU"]
    assert theirs[200][0]["TimeUS"] == 0x0707070707070707
    assert ours["IMU"]["TimeUS"].tolist() == [1000 * number for number in range(300)]
    assert ours.skipped.bad_bytes == 604


def test_pymavlink_decodes_all_records_by_the_last_definition(tmp_path):
    log = LogWriter()
    log.write("MODE", 1, 5, 5, 1)
    log.define(6, "CTUN", "QMBB", "TimeUS,X,Y,Z")
    log.write("CTUN", 2, 6, 7, 8)
    path = written(tmp_path, log.data)
    ours, theirs = open_log(path), pymavlink_rows(path)
    assert theirs.get("MODE", []) != [] or len(theirs["CTUN"]) == 2
    assert ours["MODE"]["TimeUS"].tolist() == [1]
    assert ours["CTUN"]["TimeUS"].tolist() == [2]


def test_records_after_an_unknown_type_are_read(tmp_path):
    log = flight(records=300)
    log.data += b"\xa3\x95\x63" + b"\x01" * 20
    log.write("MSG", 10**6, "after")
    log.write("MSG", 10**6, "the end")
    ours = open_log(written(tmp_path, log.data))
    assert ours["MSG"]["Message"].tolist()[-2:] == [b"after", b"the end"]
    assert ours.skipped.unknown == {0x63: 1}


def recordings():
    folder = os.environ.get("MAVSTACK_REALDATA")
    return sorted(Path(folder).glob("*.[bB][iI][nN]")) if folder else []


@pytest.mark.skipif(not recordings(), reason="MAVSTACK_REALDATA names no folder with .BIN files")
@pytest.mark.parametrize("path", recordings(), ids=lambda path: path.name)
def test_recordings_equal_pymavlink(path):
    log, _ = assert_same(path)
    # The last record of one of them is cut off.
    assert log.skipped.total == log.skipped.truncated_bytes
