"""Texts in CSV files are no formulas, whichever program writes the file."""

from __future__ import annotations

import csv

import duckdb
import pyarrow
import pytest

from mavstack.dialects import common
from mavstack.logs import open_log
from mavstack.logs.export import ExportOptions, export_log
from mavstack.logs.export.csv_text import escape_columns, escape_formula, sql_of_column
from mavstack.wire import Encoder

FORMULAS = [
    '=HYPERLINK("http://x","y")',
    "+1+cmd",
    "-1+cmd|' /C calc'!A0",
    "@SUM(A1)",
    "\t=1",
    "\r=1",
    "+",
    "-",
    "＝1",  # noqa: RUF001
]
TEXTS = ["", "a", "PreArm: =1", "-1", "+1.5", "-.5e-3", "-inf", "'=1", "1=2", " =1"]


@pytest.mark.parametrize("text", FORMULAS)
def test_a_formula_becomes_a_text(text):
    assert escape_formula(text) == f"'{text}"


@pytest.mark.parametrize("value", [*TEXTS, 1, -1.5, None, True])
def test_other_values_stay(value):
    assert escape_formula(value) == value


def test_columns_of_arrow_and_of_sql_are_escaped_alike():
    texts = [*FORMULAS, *TEXTS, None]
    expected = [escape_formula(text) for text in texts]
    column = pyarrow.array(texts)
    table = pyarrow.table({"=name": column, "of": column.dictionary_encode(), "n": list(range(len(texts)))})
    escaped = escape_columns(table)
    assert escaped.column_names == ["'=name", "of", "n"]
    assert escaped.column(0).to_pylist() == escaped.column(1).to_pylist() == expected
    with duckdb.connect(":memory:") as connection:
        connection.register("texts", pyarrow.table({"text": column}))
        rows = connection.execute(f"SELECT {sql_of_column('text')} FROM texts").fetchall()
    assert [row[0] for row in rows] == expected


@pytest.mark.parametrize("raw_text", [False, True])
def test_an_export_to_csv_has_no_formula_unless_it_is_asked_for(tmp_path, raw_text):
    encoder, log = Encoder(1, 1), tmp_path / "flight.tlog"
    messages = [common.Statustext(severity=6, text=text) for text in ("=1+1", "-5", "plain")]
    log.write_bytes(b"".join((1 << 50).to_bytes(8) + encoder.encode(message) for message in messages))
    with open_log(log) as opened:
        export_log(opened, "csv", tmp_path / "out", options=ExportOptions(raw_text=raw_text))
    with (tmp_path / "out" / "STATUSTEXT.csv").open(newline="") as file:
        texts = [row["text"] for row in csv.DictReader(file)]
    assert texts == ["=1+1" if raw_text else "'=1+1", "-5", "plain"]
