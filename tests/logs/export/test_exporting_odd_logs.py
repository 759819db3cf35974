"""Exports of logs with odd names, unknown heights and times, and into places that cannot be written."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.errors import LogError
from mavstack.logs import merge_logs
from mavstack.logs.export import ExportOptions, export_log, exporter, exporter_names
from mavstack.logs.export.flights import flight_name
from tests.logs.dataflash.writer import LogWriter
from tests.logs.files import START, encoded, stamped
from tests.logs.memory_log import MemoryLog
from tests.logs.ulog.ulog_files import UlogBuilder


@pytest.mark.parametrize("name", exporter_names())
def test_a_place_that_cannot_be_written_is_reported(flight, tmp_path, name):
    (tmp_path / "file").write_text("not a folder")
    target = tmp_path / "file" / f"out{exporter(name).suffix}"
    with pytest.raises(LogError, match="cannot write"):
        export_log(flight, name, target)


def test_a_log_that_was_removed_is_reported(tmp_path):
    path = tmp_path / "gone.tlog"
    path.write_bytes(stamped(encoded([common.Attitude()])))
    log = open_log(path, "common")
    path.unlink()
    (tmp_path / "old.csv").mkdir()
    assert export_log(log, "csv", tmp_path / "old.csv").rows == {"ATTITUDE": 1}, "its bytes are still there"
    with pytest.raises(LogError, match=f"cannot write {path}"):
        export_log(log, "parquet", tmp_path / "dataset")


def test_the_name_of_a_flight_comes_from_its_content(tmp_path):
    size = 1 << 18
    names = set()
    for position, value in ((0, 0), (0, 1), (size - 1, 1)):
        data = bytearray(size)
        data[position] = value
        (tmp_path / "flight.BIN").write_bytes(data)
        log = MemoryLog({}, path=tmp_path / "flight.BIN")
        log.size = size
        names.add(flight_name(log))
    assert len(names) == 3, "both ends of the file count"


def test_columns_of_one_name_in_matlab_are_kept(tmp_path):
    import scipy.io

    long = "x" * 70
    builder = UlogBuilder().formats(f"t:uint64_t timestamp;float a_b;part a;float {long}1;float {long}2;")
    builder.formats("part:float b;").subscribe(0, "t").record(0, "Q4f", 1, 1.5, 2.5, 3.5, 4.5)
    (tmp_path / "a.ulg").write_bytes(builder.data)
    export_log(open_log(tmp_path / "a.ulg"), "mat", tmp_path / "a.mat")
    content = scipy.io.loadmat(tmp_path / "a.mat", squeeze_me=True)["t"]
    values = [float(content[name]) for name in content.dtype.names if name not in ("f_time", "f_instance")]
    assert values == [1.0, 1.5, 2.5, 3.5, 4.5]


def test_the_schema_of_mcap_is_that_of_the_values(flight, tmp_path):
    from mcap.reader import make_reader

    kinds = {}
    for scaled, enums in ((False, False), (True, False), (False, True)):
        export_log(flight, "mcap", tmp_path / "a.mcap", options=ExportOptions(scaled=scaled, enums=enums))
        with (tmp_path / "a.mcap").open("rb") as file:
            for schema, _, message in make_reader(file).iter_messages(
                topics=["/1/HEARTBEAT", "/1/GLOBAL_POSITION_INT"]
            ):
                properties, values = json.loads(schema.data)["properties"], json.loads(message.data)
                for name in ("type", "alt"):
                    if name in values:
                        kinds[scaled, enums, name] = properties[name]["type"], type(values[name])
    assert kinds == {
        (False, False, "type"): ("integer", int),
        (False, False, "alt"): ("integer", int),
        (True, False, "type"): ("number", int),  # whole numbers
        (True, False, "alt"): ("number", int),
        (False, True, "type"): ("string", str),
        (False, True, "alt"): ("integer", int),
    }


def test_a_position_without_altitude_is_none(tmp_path):
    columns = {
        "TimeUS": [1, 2, 3],
        "Lat": [47.0, 47.1, 47.2],
        "Lng": [8.0, 8.1, 8.2],
        "Alt": [488.0, np.nan, 490.0],
    }
    log = MemoryLog({"POS": columns})
    export_log(log, "geojson", tmp_path / "a.geojson")
    (feature,) = json.loads((tmp_path / "a.geojson").read_text())["features"]
    assert feature["geometry"]["coordinates"] == [[8.0, 47.0, 488.0], [8.2, 47.2, 490.0]]


def test_times_beyond_those_of_mcap(tmp_path):
    from mcap.reader import make_reader

    log = MemoryLog({"X": {"TimeUS": [1, 2**62]}})
    export_log(log, "mcap", tmp_path / "a.mcap")
    with (tmp_path / "a.mcap").open("rb") as file:
        times = [message.log_time for _, _, message in make_reader(file).iter_messages()]
    assert times == [1000, (2**64 - 1) // 1000 * 1000]


def test_the_vehicle_of_onboard_rows_in_a_merged_log(flight, tmp_path):
    onboard = LogWriter()
    onboard.write("PARM", 1000, "SYSID_THISMAV", 1.0, 1.0)
    for second in range(10):
        onboard.gps(second * 1_000_000, START)
    (tmp_path / "a.BIN").write_bytes(onboard.data)
    merged = merge_logs(flight, open_log(tmp_path / "a.BIN"))
    files = export_log(merged, "parquet", tmp_path / "set").files
    vehicles = {(path.parent.name, path.parent.parent.parent.name) for path in files}
    assert ("message=GPS", "vehicle=1") in vehicles
    assert ("message=ATTITUDE", "vehicle=1") in vehicles
