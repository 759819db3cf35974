"""Blackbox logs: every value of frames that the tests wrote, several flights, damage."""

from __future__ import annotations

import random

import numpy as np
import pytest

from mavstack import open_log
from mavstack.errors import LogError
from mavstack.logs.blackbox import BlackboxLog
from mavstack.logs.export import export_log
from mavstack.logs.tracks import tracks
from tests.logs.blackbox.writer import GPS, HOME_PLACE, MAIN, flight
from tests.logs.conformance import LogConformance

START_US = 1_700_000_000_000_000


class TestBlackbox(LogConformance):
    format = "blackbox"
    has_damage_when_truncated = True

    def write(self, folder):
        path = folder / "log.dat"
        path.write_bytes(bytes(flight().data))
        return path


@pytest.fixture
def opened(tmp_path):
    def open_bytes(*parts):
        path = tmp_path / "log.bbl"
        path.write_bytes(b"".join(bytes(getattr(part, "data", part)) for part in parts))
        return open_log(path)

    return open_bytes


def flat(log, key, fields):
    """Return the fields of a table as rows of numbers."""
    return np.column_stack([np.asarray(log[key][name]).astype(np.int64) for name in fields]).tolist()


def main_rows(log, key="MAIN"):
    return flat(log, key, [field[0] for field in MAIN])


@pytest.mark.parametrize("seed", range(4))
def test_every_value_of_every_frame(opened, seed):
    written = flight(seed, frames=400)
    log = opened(written)
    assert isinstance(log, BlackboxLog)
    assert {name: len(rows) for name, rows in written.rows.items()} == log.counts
    assert main_rows(log) == written.rows["MAIN"]
    names = ("flightModeFlags", "stateFlags", "failsafePhase", "rxSignalReceived", "rxFlightChannelsValid")
    assert flat(log, "SLOW", names) == written.rows["SLOW"]
    assert flat(log, "GPS", [field[0] for field in GPS]) == written.rows["GPS"]
    assert flat(log, "HOME", ("GPS_home[0]", "GPS_home[1]")) == [list(HOME_PLACE)]
    assert [[kind] for kind in log["EVENT"]["event"].tolist()] == written.rows["EVENT"]
    assert not log.skipped


def test_columns_units_and_names(opened):
    log = opened(flight())
    table = log["MAIN"]
    assert table["gyroADC"].shape == (200, 3)
    assert table["motor"].dtype == np.uint32
    assert table["axisP"].dtype == np.int32
    schema = log.schema("MAIN")
    names = ("time", "gyroADC", "vbatLatest", "rssi")
    units = {name: (schema[name].unit, schema[name].multiplier) for name in names}
    assert units == {
        "time": ("us", 1.0),
        "gyroADC": ("deg/s", 1.0),
        "vbatLatest": ("V", 0.01),
        "rssi": ("%", 100 / 1024),
    }
    assert log.schema("GPS")["GPS_coord[0]"].multiplier == 1e-7
    assert log["SLOW"].enum_names("flightModeFlags")[0] == "ARM"
    assert log["SLOW"].enum_names("stateFlags")[0] == "GPS_FIX_HOME|GPS_FIX"
    assert log["EVENT"].enum_names("event")[-1] == "LOG_END"


def test_facts_of_the_header(opened):
    log = opened(flight(), flight(headers=["rollPID:50,80,40"], start_us=90_000_000))
    assert log.info["firmware_version"] == "Betaflight 4.4.2 (23d066d08) STM32F405"
    assert log.info["craft"] == "test"
    assert log.info["flights"] == "2"
    assert log.parameters["rollPID[0]"] == 45
    assert [(change.name, change.value) for change in log.parameter_changes] == [("rollPID[0]", 50)]
    texts = [text.text for text in log.texts]
    assert texts[:2] == ["FLIGHT_MODE: ARM|ANGLE", "INFLIGHT_ADJUSTMENT"]
    assert texts.count("DISARM: SWITCH") == 2
    assert log["EVENT"]["value"][1] == 4
    assert log["EVENT"]["detail"][1:3].tolist() == [-12, 1.5]


def test_times(opened):
    log = opened(flight())
    times = log["MAIN"]["_time"].astype("i8")
    assert times[0] == START_US
    assert times[-1] - times[0] == log["MAIN"]["time"][-1] - log["MAIN"]["time"][0]
    assert log.time_base.kind == "utc"
    assert log["SLOW"]["time"][0] == log["MAIN"]["time"][0], "before the first main frame"
    unknown = opened(flight(start="0000-01-01T00:00:00.000+00:00"))
    assert np.isnat(unknown["MAIN"]["_time"]).all()
    assert unknown.time_base.kind == "boot"
    assert unknown.times("MAIN")[0] == pytest.approx(5.0, abs=1e-4)


def test_the_clock_of_32_bits_rolls_over(opened):
    log = opened(flight(start_us=2**32 - 10_000))
    times = log["MAIN"]["time"]
    assert (np.diff(times) > 0).all()
    assert times[-1] > 2**32
    assert not log.skipped


def test_flights_of_a_file(opened):
    other = tuple(field for field in MAIN if not field[0].startswith("motor"))
    first, second, third = flight(1), flight(2, start_us=400_000_000), flight(3, main=other)
    log = opened(first, b"\xff" * 500, second, third)
    assert log.counts["MAIN"] == 400
    assert log.counts["MAIN_2"] == 200
    assert main_rows(log, "MAIN[1]") == second.rows["MAIN"]
    assert log["MAIN_2"]["_instance"].tolist() == [2] * 200
    assert log.select(instance=1).counts["GPS"] == len(second.rows["GPS"])
    assert not log.skipped, "an erased part of the flash chip is no damage"
    records = [record["_instance"] for record in log.records()]
    assert records == sorted(records)


def test_damage_costs_frames_up_to_the_next_key_frame(opened):
    written = flight(frames=300)
    marks = [mark for mark in written.marks if written.data[mark : mark + 1] in (b"I", b"P")]
    place = marks[100]
    data = bytearray(written.data)
    data[place + 1 : place + 6] = b"\xff" * 5
    log = opened(data)
    rows = main_rows(log)
    lost = [row for row in written.rows["MAIN"] if row not in rows]
    assert all(row in written.rows["MAIN"] for row in rows)
    assert 12 >= len(lost) > 0, "frame 100, and those up to frame 112"
    assert log.skipped.bad_records >= 1
    assert log.skipped.other["frames out of sequence"] == len(lost) - 1


def test_a_lost_part_of_a_flight_does_not_cost_the_rest(opened):
    written = flight(frames=6000)
    marks = [mark for mark in written.marks if written.data[mark : mark + 1] in (b"I", b"P")]
    log = opened(written.data[: marks[160]] + written.data[marks[5600] :])
    times = log["MAIN"]["time"]
    assert len(times) >= 160 + 400 - 17
    assert log.skipped.other["frames out of sequence"] >= 16


@pytest.mark.parametrize("seed", range(25))
def test_frames_outside_of_random_damage_are_found(opened, seed):
    rng = random.Random(seed)
    written = flight(seed, frames=300)
    data, first = bytearray(written.data), written.marks[0]
    for _ in range(4):
        place = rng.randrange(first, len(data))
        size = rng.choice([1, 5, 40])
        data[place : place + size] = rng.choice([rng.randbytes(size), b"", bytes(size)])
    log = opened(data)
    known = {tuple(row) for row in written.rows["MAIN"]}
    found = [row for row in map(tuple, main_rows(log)) if row in known]
    assert len(found) >= 300 - 4 * 33
    assert log.skipped or len(found) == 300


@pytest.mark.parametrize("seed", range(40))
def test_any_bytes_are_read(tmp_path, seed):
    rng = random.Random(seed)
    data = bytearray(flight(seed, frames=60).data)
    for _ in range(rng.randrange(1, 40)):
        data[rng.randrange(60, len(data))] = rng.randrange(256)
    path = tmp_path / "x"
    path.write_bytes(data[: rng.choice([len(data), rng.randrange(80, len(data))])])
    try:
        log = open_log(path, format="blackbox")
    except LogError as error:
        assert "complete header" in str(error)  # noqa: PT017 (most files are read)
        return
    log.load()
    assert sum(1 for _ in log.records()) == sum(log.counts.values())
    assert log.skipped.describe()


def test_header_without_definitions(tmp_path):
    path = tmp_path / "x"
    path.write_bytes(b"H Product:Blackbox flight data recorder\nH Data version:2\nI\x00\x00")
    with pytest.raises(LogError, match="no flight in it has a complete header"):
        open_log(path)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"Field S signed:0", b"Field S signed:1,0,1,0,1,0"),
        (b",failsafePhase", b",_time"),
        (b",failsafePhase", b","),
    ],
)
def test_damaged_definitions(tmp_path, old, new):
    data = flight(frames=60).data
    assert old in data
    path = tmp_path / "x"
    path.write_bytes(data.replace(old, new))
    log = open_log(path)
    log.load()
    assert len(log["MAIN"]) == 60


def test_unknown_encodings_are_counted(opened):
    data = bytes(flight().data).replace(b"Field S encoding:1", b"Field S encoding:4")
    log = opened(data, flight())
    assert log.counts["MAIN"] == 200
    assert log.skipped.other == {"flights with unusable headers": 1}
    assert log.skipped.bad_bytes == len(data)


def test_track_and_exports(opened, tmp_path):
    written = flight()
    log = opened(written)
    (track,) = tracks(log)
    assert len(track) == len(written.rows["GPS"])
    assert track.latitudes[0] == pytest.approx(written.rows["GPS"][0][2] * 1e-7)
    assert track.altitudes[0] == pytest.approx(written.rows["GPS"][0][4] / 10)
    assert export_log(log, "kml", tmp_path / "x.kml").description.endswith("points of 1 vehicle")
    assert export_log(log, "csv", tmp_path / "csv").rows == log.counts


def test_main_frames_of_other_fields_are_unusable(tmp_path):
    writer = flight(frames=40)
    names = ",".join(f"x{number}" for number in range(len(MAIN) + 3))
    head, rest = bytes(writer.data).split(b"H Field P predictor", 1)
    path = tmp_path / "log.bbl"
    extra = b",0,0,0\n"
    lines = rest.split(b"\n")
    lines[0], lines[1] = lines[0] + extra.strip(), lines[1] + extra.strip()
    path.write_bytes(
        head + b"H Field P name:" + names.encode() + b"\nH Field P predictor" + b"\n".join(lines)
    )
    log = open_log(path)
    assert (dict(log.counts), log.skipped.other) == ({}, {"flights with unusable headers": 1})
