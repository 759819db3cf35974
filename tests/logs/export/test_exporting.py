"""Exports of a log in every format, read back by the libraries of these formats."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, LogError, UnknownMessageError
from mavstack.logs.export import ExportOptions, export_log, exporter, exporter_names
from tests.logs.files import encoded, stamped

#: The rows that formats of tracks write: those with positions of both vehicles.
TRACK_ROWS = {key: {"GLOBAL_POSITION_INT": 20} for key in ("kml", "gpx", "geojson")}


@pytest.mark.parametrize("name", exporter_names())
def test_an_export_leaves_complete_files_only(flight, tmp_path, name):
    chosen = exporter(name)
    target = tmp_path / "out" if chosen.makes_folder else tmp_path / f"out{chosen.suffix}"
    calls = []
    summary = export_log(flight, name, target, progress=lambda done, size: calls.append((done, size)))
    written = sorted(path for path in tmp_path.rglob("*") if path.is_file() and path != flight.path)
    assert written == sorted(summary.files)
    assert all(path.suffix == chosen.suffix and path.stat().st_size for path in written)
    assert summary.rows == TRACK_ROWS.get(name, flight.counts)
    assert summary.to_dict()["skipped"]["total"] == 0
    assert calls[-1] == (flight.size, flight.size)


@pytest.mark.parametrize("name", exporter_names())
def test_an_export_that_fails_leaves_nothing(flight, tmp_path, name):
    chosen = exporter(name)
    target = tmp_path / "out" if chosen.makes_folder else tmp_path / f"out{chosen.suffix}"

    def fail(done, size):
        raise OSError(28, "No space left on device")

    with pytest.raises(LogError, match=f"cannot write {target}: No space left on device"):
        export_log(flight, name, target, progress=fail)
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [flight.path]


def test_only_some_tables(flight, tmp_path):
    assert export_log(flight, "csv", tmp_path / "csv", names=["ATTITUDE"]).rows == {"ATTITUDE": 10}
    with pytest.raises(UnknownMessageError, match="contains no NOTHING; it contains HEARTBEAT"):
        export_log(flight, "csv", tmp_path / "csv", names=["NOTHING"])
    with pytest.raises(InvalidArgumentError, match="format must be one of parquet, csv"):
        export_log(flight, "xls", tmp_path / "x")


# the same numbers in every format


def test_parquet(flight, tmp_path):
    import duckdb
    import pyarrow.parquet

    export_log(flight, "parquet", tmp_path / "dataset")
    folder = tmp_path / "dataset" / "vehicle=1" / "date=2023-11-14"
    (file,) = (folder / "message=BATTERY_STATUS").iterdir()
    table = pyarrow.parquet.read_table(file, partitioning=None)
    assert table["voltages"].to_pylist() == flight["BATTERY_STATUS"]["voltages"].tolist()
    assert table["_time"].to_pylist()[0].isoformat() == "2023-11-14T22:13:20.300000+00:00"
    assert table.schema.field("voltages").metadata[b"unit"] == b"V"
    assert table.schema.field("type").metadata[b"enum"] == b"MAV_BATTERY_TYPE"
    origin = json.loads(table.schema.metadata[b"mavstack.table"])
    assert (origin["name"], origin["source"]) == ("BATTERY_STATUS", "common")
    (enum,) = [field["enum_values"] for field in origin["fields"] if field["name"] == "type"]
    assert enum["1"] == "LIPO"
    rows = duckdb.sql(
        f"SELECT vehicle, count(*) FROM read_parquet('{tmp_path}/dataset/**/*.parquet', union_by_name=true) "
        "WHERE message = 'GLOBAL_POSITION_INT' GROUP BY 1 ORDER BY 1"
    ).fetchall()
    assert rows == [(1, 10), (2, 10)]


def test_a_parquet_dataset_can_be_added_to_and_repeated(flight, tmp_path):
    first = export_log(flight, "parquet", tmp_path / "dataset")
    times = {path: path.stat().st_ino for path in first.files}
    again = export_log(flight, "parquet", tmp_path / "dataset")
    assert sorted(again.files) == sorted(first.files)
    assert all(path.stat().st_ino != times[path] for path in again.files), "replaced"
    other = tmp_path / "other.tlog"
    other.write_bytes(stamped(encoded([common.Attitude(roll=1.0)])))
    added = export_log(open_log(other, "common"), "parquet", tmp_path / "dataset")
    assert not set(added.files) & set(first.files)
    assert len(list((tmp_path / "dataset").rglob("*ATTITUDE/*.parquet"))) == 2


def test_a_log_with_very_many_systems_has_a_bounded_number_of_open_files(tmp_path, monkeypatch):
    import pyarrow.parquet

    monkeypatch.setattr("mavstack.logs.export.parquet._MAX_OPEN", 3)
    path = tmp_path / "many.tlog"
    path.write_bytes(
        stamped(
            [packet for system in range(1, 8) for packet in encoded([common.Attitude()] * 2, system=system)]
        )
    )
    log = open_log(path, "common")
    tables = dict(log)
    monkeypatch.setattr(type(log), "windows", lambda *a, **k: iter([tables] * 2))
    summary = export_log(log, "parquet", tmp_path / "dataset")
    rows = [pyarrow.parquet.read_metadata(file).num_rows for file in summary.files]
    assert sum(rows) == 28
    assert len({file.parent for file in summary.files}) == 7
    assert len(summary.files) > 7, "the oldest files were closed, and continued in others"


def test_arrow(flight, tmp_path):
    import pyarrow

    export_log(flight, "arrow", tmp_path / "arrow")
    with pyarrow.memory_map(str(tmp_path / "arrow" / "GLOBAL_POSITION_INT.arrow")) as source:
        table = pyarrow.ipc.open_file(source).read_all()
        assert table["lat"].to_pylist() == flight["GLOBAL_POSITION_INT"]["lat"].tolist()


def test_csv(flight, tmp_path):
    import pandas as pd

    export_log(flight, "csv", tmp_path / "csv", options=ExportOptions(scaled=True, enums=True))
    attitudes = pd.read_csv(tmp_path / "csv" / "ATTITUDE.csv")
    assert attitudes["roll"].to_numpy() == pytest.approx(flight["ATTITUDE"]["roll"])
    assert attitudes["pitch"].isna().all()
    assert str(attitudes["_time"][0]).startswith("2023-11-14 22:13:20.100000")
    beats = pd.read_csv(tmp_path / "csv" / "HEARTBEAT.csv")
    assert set(beats["type"]) == {"QUADROTOR", "GCS"}
    positions = pd.read_csv(tmp_path / "csv" / "GLOBAL_POSITION_INT.csv")
    assert positions["lat"][0] == pytest.approx(47.0)
    batteries = pd.read_csv(tmp_path / "csv" / "BATTERY_STATUS.csv")
    assert batteries["voltages_1"][0] == pytest.approx(4.001)
    assert batteries["voltages_2"].isna().all(), "the definition's mark of an absent cell"


def test_mat(flight, tmp_path):
    import scipy.io

    export_log(flight, "mat", tmp_path / "flight.mat")
    content = scipy.io.loadmat(tmp_path / "flight.mat", squeeze_me=True, struct_as_record=False)
    attitude = content["ATTITUDE"]
    assert attitude.roll == pytest.approx(flight["ATTITUDE"]["roll"])
    assert np.isnan(attitude.pitch).all()
    assert attitude.f_time[0] == pytest.approx(1_700_000_000.1)
    assert content["BATTERY_STATUS"].voltages.tolist() == flight["BATTERY_STATUS"]["voltages"].tolist()
    assert content["STATUSTEXT"].text[3] == "second 3"


def test_mcap(flight, tmp_path):
    from mcap.reader import make_reader

    export_log(flight, "mcap", tmp_path / "flight.mcap", options=ExportOptions(enums=True))
    with (tmp_path / "flight.mcap").open("rb") as file:
        found = {}
        schemas = {}
        for schema, channel, message in make_reader(file).iter_messages():
            found.setdefault(channel.topic, []).append((message.log_time, json.loads(message.data)))
            schemas[channel.topic] = schema.name
    assert len(found["/1/ATTITUDE"]) == 10
    time, attitude = found["/1/ATTITUDE"][3]
    assert time == 1_700_000_003_100_000_000
    assert (attitude["roll"], attitude["pitch"]) == (pytest.approx(0.3), None)
    assert found["/1/HEARTBEAT"][0][1]["type"] == "QUADROTOR"
    assert schemas["/2/location"] == "foxglove.LocationFix"
    assert found["/2/location"][0][1]["latitude"] == pytest.approx(48.0)
    assert schemas["/log"] == "foxglove.Log"
    assert found["/log"][9][1]["message"] == "second 9"
    assert found["/log"][0][1]["timestamp"] == {"sec": 1_700_000_000, "nsec": 400_000_000}


KML = "{http://www.opengis.net/kml/2.2}"
TRACKS = "{http://www.google.com/kml/ext/2.2}"


def test_kml(flight, tmp_path):
    export_log(flight, "kml", tmp_path / "flight.kml")
    root = ElementTree.parse(tmp_path / "flight.kml").getroot()
    names = [name.text for name in root.iter(f"{KML}name")]
    assert names == ["flight.tlog", "vehicle 1", "vehicle 2"]
    assert next(when.text for when in root.iter(f"{KML}when")) == "2023-11-14T22:13:20.200Z"
    assert next(root.iter(f"{TRACKS}coord")).text == "8.5 47.0 488.0"


def test_gpx(flight, tmp_path):
    export_log(flight, "gpx", tmp_path / "flight.gpx")
    points = list(ElementTree.parse(tmp_path / "flight.gpx").getroot().iter())
    points = [point for point in points if point.tag.endswith("trkpt")]
    assert len(points) == 20
    assert points[1].attrib == {"lat": "47.0001", "lon": "8.5"}


def test_geojson(flight, tmp_path):
    export_log(flight, "geojson", tmp_path / "flight.geojson")
    content = json.loads((tmp_path / "flight.geojson").read_text())
    first, second = content["features"]
    assert first["geometry"]["type"] == "LineString"
    assert first["geometry"]["coordinates"][1] == [8.5, 47.0001, 489.0]
    assert len(first["properties"]["coordTimes"]) == 10
    assert second["properties"]["system"] == 2


@pytest.mark.parametrize("name", ["kml", "gpx", "geojson"])
def test_a_track_is_described_by_its_points_and_vehicles(flight, tmp_path, name):
    assert export_log(flight, name, tmp_path / "a").description == "20 points of 2 vehicles"
    one = flight.select(system=2, end=0.9)
    assert export_log(one, name, tmp_path / "b").description == "1 point of 1 vehicle"
    summary = export_log(flight, name, tmp_path / "c", names=["GLOBAL_POSITION_INT"])
    assert summary.to_dict()["description"] == "20 points of 2 vehicles"
    with pytest.raises(LogError, match="it holds no position"):
        export_log(flight, name, tmp_path / "d", names=["ATTITUDE"])


def test_a_log_is_never_written_over_itself(flight):
    content = flight.path.read_bytes()
    with pytest.raises(LogError, match="it is the log itself"):
        export_log(flight, "tlog", flight.path)
    assert flight.path.read_bytes() == content


@pytest.mark.parametrize("name", ["kml", "gpx", "geojson"])
def test_a_track_needs_positions(tmp_path, name):
    path = tmp_path / "none.tlog"
    path.write_bytes(stamped(encoded([common.Attitude()])))
    with pytest.raises(LogError, match="it holds no position"):
        export_log(open_log(path, "common"), name, tmp_path / f"x.{name}")
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", ["csv", "tlog", "kml"])
def test_a_file_without_records_is_no_export(tmp_path, name):
    path = tmp_path / "letter.tlog"
    path.write_bytes(b"no packets here")
    with pytest.raises(LogError, match="there is nothing to write; skipped: 15 bad bytes"):
        export_log(open_log(path, "common"), name, tmp_path / "out")
