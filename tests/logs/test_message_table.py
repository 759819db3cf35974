"""The tables of a log as data frames of pandas, polars and Arrow."""

from __future__ import annotations

import pickle
import sys

import numpy as np
import pytest

from mavstack.dialects import Dialect, common
from mavstack.errors import InvalidArgumentError, MissingExtraError
from mavstack.logs import MessageTable, open_log

from .files import encoded, stamped

HEADER = ["_time", "_system", "_component", "_sequence", "_version"]
VOLTAGES = [f"voltages_{index}" for index in range(10)]
MESSAGES = [
    common.BatteryStatus(voltages=range(10), voltages_ext=(1, 2, 3, 4), current_battery=-1),
    common.BatteryStatus(voltages=range(10, 20), current_battery=1234),
    common.ParamValue(param_id="RTL_ALT", param_value=1.5),
    common.Statustext(text="größer"),
    common.Attitude(roll=0.5),
]


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "flight.tlog"
    # The last packet has no timestamp.
    path.write_bytes(stamped(encoded(MESSAGES)) + encoded([common.Attitude(roll=1)])[0])
    return open_log(path, "common")


def test_columns_are_plain_arrays_and_rows_are_tables(log):
    table = log["ATTITUDE"]
    assert type(table) is MessageTable
    assert type(table["roll"]) is type(table["roll"] + 1) is np.ndarray
    assert type(table[:1]) is type(table[table["roll"] > 0]) is type(table[["_time", "roll"]]) is MessageTable
    assert type(table == table.copy()) is np.ndarray
    assert table[0]["roll"] == 0.5
    assert [row["roll"] for row in table] == [0.5, 1]
    again = pickle.loads(pickle.dumps(table))
    assert type(again) is MessageTable
    assert again.tobytes() == table.tobytes()
    assert list(table[["roll"]].frame()) == ["roll"]


def test_a_frame_has_a_column_for_each_element_of_an_array(log):
    frame = log["BATTERY_STATUS"].frame()
    assert list(frame)[:5] == HEADER
    assert [name for name in frame if name.startswith("voltages_") and "ext" not in name] == VOLTAGES
    assert frame["voltages_3"].tolist() == [3, 13]
    assert frame["voltages_3"].dtype == np.uint16
    assert frame["voltages_ext_1"].tolist() == [2, 0]
    assert all(column.ndim == 1 and column.flags.c_contiguous for column in frame.values())
    assert frame["_time"].dtype == np.dtype("M8[us]")
    assert log["PARAM_VALUE"].frame()["param_id"].tolist() == ["RTL_ALT"]
    assert log["STATUSTEXT"].frame()["text"].tolist() == ["größer"]
    lists = log["BATTERY_STATUS"].frame(arrays="lists")
    assert lists["voltages"].tolist() == [list(range(10)), list(range(10, 20))]
    with pytest.raises(InvalidArgumentError, match='arrays must be "columns" or "lists", got \'rows\''):
        log["BATTERY_STATUS"].frame("rows")


def test_an_element_never_hides_a_field(tmp_path):
    xml = tmp_path / "custom.xml"
    xml.write_text(
        '<mavlink><messages><message id="9000" name="MINE"><field type="uint8_t[2]" name="cell"/>'
        '<field type="uint8_t" name="cell_1"/></message></messages></mavlink>'
    )
    dialect = Dialect.from_xml(xml)
    path = tmp_path / "flight.tlog"
    path.write_bytes(stamped(encoded([dialect["MINE"](cell=(5, 6), cell_1=7)])))
    frame = open_log(path, dialect)["MINE"].frame()
    assert {name: column.tolist() for name, column in frame.items() if "cell" in name} == {
        "cell_0": [5],
        "cell[1]": [6],
        "cell_1": [7],
    }


def test_pandas(log):
    pd = pytest.importorskip("pandas")
    frame = log["BATTERY_STATUS"].to_pandas()
    assert frame[VOLTAGES].to_numpy().tolist() == [list(range(10)), list(range(10, 20))]
    assert frame["current_battery"].tolist() == [-1, 1234]
    assert frame["_time"][0] == pd.Timestamp("2023-11-14T22:13:20", tz="UTC")
    assert log["BATTERY_STATUS"].to_pandas(arrays="lists")["voltages"][1] == list(range(10, 20))
    assert log["PARAM_VALUE"].to_pandas()["param_id"].tolist() == ["RTL_ALT"]
    assert log["ATTITUDE"].to_pandas()["_time"].isna().tolist() == [False, True]
    assert pd.DataFrame(log["BATTERY_STATUS"].frame())["voltages_9"].tolist() == [9, 19]


def test_polars(log):
    pl = pytest.importorskip("polars")
    frame = log["BATTERY_STATUS"].to_polars()
    assert frame["voltages_9"].to_list() == [9, 19]
    assert frame.schema["_time"] == pl.Datetime("us", "UTC")
    assert log["BATTERY_STATUS"].to_polars("lists")["voltages"].to_list()[1] == list(range(10, 20))
    assert log["PARAM_VALUE"].to_polars()["param_id"].to_list() == ["RTL_ALT"]
    assert log["ATTITUDE"].to_polars()["_time"].is_null().to_list() == [False, True]


def test_arrow(log, tmp_path):
    pa = pytest.importorskip("pyarrow")
    table = log["BATTERY_STATUS"].to_arrow()
    assert table["voltages_9"].to_pylist() == [9, 19]
    assert table.schema.field("_time").type == pa.timestamp("us", tz="UTC")
    lists = log["BATTERY_STATUS"].to_arrow(arrays="lists")
    assert lists["voltages"].to_pylist() == [list(range(10)), list(range(10, 20))]
    assert log["PARAM_VALUE"].to_arrow()["param_id"].to_pylist() == ["RTL_ALT"]
    assert log["ATTITUDE"].to_arrow()["_time"].null_count == 1
    parquet = pytest.importorskip("pyarrow.parquet")
    parquet.write_table(lists, tmp_path / "battery.parquet")
    again = parquet.read_table(tmp_path / "battery.parquet")
    assert again["voltages"].to_pylist() == lists["voltages"].to_pylist()


@pytest.mark.parametrize("library", ["pandas", "polars", "pyarrow"])
def test_every_message_with_an_array_becomes_a_frame(tmp_path, library):
    pytest.importorskip(library)
    messages = [message() for message in Dialect.load("ardupilotmega")]
    path = tmp_path / "all.tlog"
    path.write_bytes(stamped(encoded(messages)))
    method = {"pandas": "to_pandas", "polars": "to_polars", "pyarrow": "to_arrow"}[library]
    for name, table in open_log(path, "ardupilotmega").items():
        for arrays in ("columns", "lists"):
            frame = getattr(table, method)(arrays)
            names = frame.column_names if library == "pyarrow" else frame.columns
            assert (len(frame), list(names)) == (1, list(table.frame(arrays))), name


@pytest.mark.parametrize(
    ("method", "library", "extra"),
    [("to_pandas", "pandas", "pandas"), ("to_polars", "polars", "polars"), ("to_arrow", "pyarrow", "arrow")],
)
def test_a_missing_library_is_named_with_its_extra(log, monkeypatch, method, library, extra):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(MissingExtraError) as raised:
        getattr(log["ATTITUDE"], method)()
    assert str(raised.value) == f"{method}() needs an extra: pip install 'mavstack[{extra}]'"
