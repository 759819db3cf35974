"""DataFlash logs as text, also compared with pymavlink's reader and with the binary log of equal content."""

from __future__ import annotations

import random

import numpy as np
import pytest

from mavstack.logs import open_log

from .reference import assert_equal_rows, pymavlink_rows
from .writer import flight

HEAD = """FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns
FMT, 1, 10, GPS, QBBIHBcLLefff, TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ
FMT, 5, 75, MSG, QZ, TimeUS,Message
FMT, 6, 14, MODE, QMBB, TimeUS,Mode,ModeNum,Rsn
FMT, 4, 31, PARM, QNff, TimeUS,Name,Value,Default
FMT, 129, 44, FMTU, QBNN, TimeUS,FmtType,UnitIds,MultIds
FMT, 130, 76, UNIT, QbZ, TimeUS,Id,Label
UNIT, 900, 109, m
UNIT, 900, 45,
FMTU, 900, 1, s#---SmDUmnhn, F----0-GGB000
"""


def opened(tmp_path, text):
    path = tmp_path / "flight.log"
    path.write_text(HEAD + text, "utf-8")
    return open_log(path)


def as_text(log):
    """Return a binary log as text, as ground stations convert it."""
    lines = []
    for record in log.records():
        if record.name in ("FILE", "ISBD", "ALL"):
            continue
        values = [value for name, value in record.items() if not name.startswith("_")]
        lines.append(", ".join([record.name, *map(str, values)]))
    return "\n".join(lines) + "\n"


def test_the_tables_are_those_of_the_binary_log(tmp_path):
    path = tmp_path / "log.BIN"
    path.write_bytes(bytes(flight(records=300).data))
    binary = open_log(path)
    text_path = tmp_path / "log.log"
    text_path.write_text(as_text(binary), "utf-8")
    text = open_log(text_path)
    assert text.format == "dataflash-text"
    assert text.time_base == binary.time_base
    for name in ("IMU", "GPS", "ATT", "BAT", "MSG", "PARM"):
        for column in binary[name].dtype.names:
            np.testing.assert_array_equal(text[name][column], binary[name][column], f"{name}.{column}")
    assert text.schema("BAT") == binary.schema("BAT")
    assert text.info == binary.info
    assert not text.skipped


def test_pymavlink_reads_the_same_values(tmp_path):
    from pymavlink import DFReader

    rng = random.Random(1)
    lines = [
        f"GPS, {1000 * number}, 0, 3, {number}, 2300, 9, {rng.uniform(0, 2):.2f}, {rng.uniform(-90, 90):.7f}"
        f", {rng.uniform(-180, 180):.7f}, {rng.uniform(-10, 900):.2f}, 1.5, 2.25, -0.5"
        for number in range(1, 60)
    ]
    lines += [
        "MSG, 70000, ArduCopter V3.2",
        "MODE, 70000, STABILIZE, 0, 1",
        "PARM, 70000, RTL_ALT, 1500.0, 1500.0",
    ]
    log = opened(tmp_path, "\n".join(lines) + "\n")
    theirs = pymavlink_rows(log.path, DFReader.DFReader_text)
    for name in ("GPS", "MSG", "MODE", "PARM"):
        assert_equal_rows(log, name, theirs[name])


def test_texts_keep_their_commas(tmp_path):
    # pymavlink cuts the text at the first comma.
    log = opened(tmp_path, "MSG, 5, Mission: 3 WP, 2 left, done\n")
    assert [text.text for text in log.texts] == ["Mission: 3 WP, 2 left, done"]


def test_lines_without_spaces_and_lines_before_the_first_definition_are_read(tmp_path):
    path = tmp_path / "old.log"
    lines = ["1", "", "ArduCopter V3.1.5 (3c57e771)", "Free RAM: 1331", *HEAD.replace(", ", ",").splitlines()]
    path.write_text("\r\n".join([*lines, "MSG,7,old", "MODE,8,LOITER,5"]) + "\r\n", "utf-8")
    log = open_log(path)
    assert log.format == "dataflash-text"
    assert log["MSG"]["Message"].tolist() == [b"old"]
    assert "MODE" not in log, "its line has too few values"
    assert (log.skipped.bad_records, log.skipped.bad_bytes > 0) == (1, True)


@pytest.mark.parametrize(
    "line", ["MODE, x, STABILIZE, 0, 1", "MODE, 1, STABILIZE, 256, 1", "MODE, -1, A, 0, 1", "MODE, 1", "MODE"]
)
def test_lines_that_cannot_be_read_are_counted(tmp_path, line):
    log = opened(tmp_path, f"{line}\nMODE, 2, AUTO, 3, 1,\n")
    assert log["MODE"]["TimeUS"].tolist() == [2]
    assert log["MODE"]["Mode"].tolist() == [b"AUTO"]
    assert log.skipped.bad_records == 1


def test_unknown_types_are_counted(tmp_path):
    log = opened(tmp_path, "XYZ, 1, 2\nXYZ, 1, 2\n")
    assert log.skipped.other == {"lines of unknown type XYZ": 2}


def test_instances_and_units_are_those_of_fmtu(tmp_path):
    log = opened(tmp_path, "GPS, 1000, 1, 3, 5000, 2300, 9, 0.8, -35.3632610, 149.1652300, 584.0, 1, 2, 3\n")
    assert log["GPS"]["_instance"].tolist() == [1]
    assert log["GPS"]["Lat"].tolist() == [-35.363261]
    assert log.schema("GPS")["Alt"].unit == "m"
    assert not np.isnat(log["GPS"]["_time"][0])
