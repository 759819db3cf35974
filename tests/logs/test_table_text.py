"""Tables as text, and misspelt names."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.logs.message_table import MessageTable
from mavstack.logs.schema import FieldSchema, SchemaSource, TableSchema
from mavstack.logs.table_text import suggestion

KIND = [("_time", "M8[us]"), ("roll", "f4"), ("q", "f4", (2,)), ("text", "S20"), ("count", "i4")]


def table(rows):
    values = np.zeros(rows, KIND)
    values["_time"] = np.datetime64("2026-01-02T03:04:05.006") + np.arange(rows)
    values["roll"] = np.arange(rows) / 3
    values["text"] = b"a\x1b[31mb"
    values["count"] = np.arange(rows)
    return MessageTable.of(values)


def test_columns_and_a_few_rows_are_shown():
    lines = str(table(1000)).splitlines()
    assert lines[0] == "1000 rows"
    assert lines[1].split() == ["field", "type", "unit", "first", "last"]
    assert [line.split()[0] for line in lines[2:]] == ["_time", "roll", "q", "text", "count"]
    assert lines[2].split()[1:3] == ["time", "2026-01-02T03:04:05.006"]
    assert lines[3].split() == ["roll", "float32", "0", "0.333333", "0.666667", "333"]
    assert lines[4].split() == ["q", "float32[2]", *["[0", "0]"] * 4]
    assert lines[6].split() == ["count", "int32", "0", "1", "2", "999"]


def test_the_unit_is_that_of_the_values_shown():
    fields = tuple(FieldSchema(name, np.dtype(KIND)[name].base) for name, *_ in KIND[:-1])  # type: ignore[index]
    count = FieldSchema("count", np.dtype("i4"), unit="s", multiplier=1e-6)
    schema = TableSchema("T", (*fields, count))
    lines = str(MessageTable.of(np.asarray(table(1)), SchemaSource(lambda: schema))).splitlines()
    assert lines[-1].split() == ["count", "int32", "1e-06", "s", "0"]


@pytest.mark.parametrize(("rows", "shown"), [(0, 0), (1, 1), (3, 3), (4, 4), (5, 4)])
def test_every_row_is_shown_once(rows, shown):
    assert len(str(table(rows)).splitlines()[6].split()) == 2 + shown


def test_no_control_character_is_shown():
    assert "\x1b" not in str(table(2))
    assert "a·[31mb" in str(table(2))


def test_long_values_are_cut():
    values = np.zeros(1, [("text", "S80")])
    values["text"] = b"x" * 80
    assert "x" * 23 + "…" in str(MessageTable.of(values))


def test_a_misspelt_field_suggests_the_nearest():
    with pytest.raises(InvalidArgumentError, match="has no field rol; did you mean roll"):
        table(1)["rol"]
    with pytest.raises(InvalidArgumentError, match="has no field nothing; it has _time"):
        table(1)["nothing"]
    with pytest.raises(InvalidArgumentError, match="did you mean roll"):
        table(1).scaled("Rolll")


def test_a_suggestion_is_a_known_name():
    assert (
        suggestion("VEHICLE_ATTITUD", ["vehicle_attitude", "cpuload"]) == "; did you mean vehicle_attitude?"
    )
    assert suggestion("xyz", ["vehicle_attitude"]) == ""
