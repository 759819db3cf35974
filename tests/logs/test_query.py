"""Queries of logs: SQL, the short form, several logs, states."""

from __future__ import annotations

import pytest

from mavstack import open_log
from mavstack.errors import InvalidArgumentError
from mavstack.logs.query import expand_short_form, query_logs
from tests.logs.flights import flight_tlog
from tests.logs.memory_log import MemoryLog


def ask(logs, query, **options):
    return query_logs(logs, query, **options)


def test_messages_are_tables(flight):
    names, rows = ask([flight], "SELECT count(*) AS rows, max(roll) FROM attitude")
    assert names == ["rows", "max(roll)"]
    assert rows[0][0] == 10
    assert rows[0][1] == pytest.approx(0.9)


def test_messages_are_joined(flight):
    _, rows = ask(
        [flight],
        "SELECT a.roll, p.alt FROM ATTITUDE a ASOF JOIN GLOBAL_POSITION_INT p "
        "ON a._system = p._system AND a._time >= p._time",
    )
    assert len(rows) == 9, "the first attitude comes before the first position"


def test_the_short_form(flight):
    names, rows = ask([flight], "ATTITUDE.roll, ATTITUDE.time_boot_ms where roll > 0.75")
    assert names == ["_time", "roll", "time_boot_ms"]
    assert [row[2] for row in rows] == [8000, 9000]
    assert str(rows[0][0]) == "2023-11-14 22:13:28.100000"


@pytest.mark.parametrize(
    ("query", "seconds"),
    [
        ("ATTITUDE.time_boot_ms where armed", range(2, 8)),
        ("ATTITUDE.time_boot_ms where not armed", (0, 1, 8, 9)),
        ("ATTITUDE.time_boot_ms where mode = 'LAND'", range(6, 10)),
        ("ATTITUDE.time_boot_ms where armed and mode = 'LAND'", (6, 7)),
    ],
)
def test_the_state_of_the_vehicle_is_a_column(flight, query, seconds):
    _, rows = ask([flight], query)
    assert [row[1] // 1000 for row in rows] == list(seconds)


def test_states_are_those_of_the_same_vehicle(flight):
    _, rows = ask([flight], "SELECT _system, count(*) FROM global_position_int WHERE armed GROUP BY 1")
    assert rows == [(1, 6)]


def test_elements_of_arrays(flight):
    assert expand_short_form("BATTERY_STATUS.voltages[1]") == (
        'SELECT _time, "voltages"[2] AS "voltages[1]" FROM "BATTERY_STATUS"'
    )
    names, rows = ask([flight], "BATTERY_STATUS.voltages[0]")
    assert names == ["_time", "voltages[0]"]
    assert [row[1] for row in rows[:3]] == [4000, 3999, 3998]


def test_units_and_names(flight):
    _, rows = ask([flight], "SELECT any_value(lat) FROM GLOBAL_POSITION_INT WHERE _system = 2", scaled=True)
    assert 48.0 <= rows[0][0] < 48.01
    _, rows = ask([flight], "SELECT DISTINCT type FROM HEARTBEAT WHERE _system = 1", enums=True)
    assert rows == [("QUADROTOR",)]


def test_several_logs_are_one_table(flight, tmp_path):
    path = tmp_path / "other.tlog"
    path.write_bytes(flight_tlog())
    _, rows = ask(
        [flight, open_log(path, "common")], "SELECT _file, count(*) FROM VFR_HUD GROUP BY 1 ORDER BY 1"
    )
    assert rows == [("flight.tlog", 10), ("other.tlog", 10)]


@pytest.mark.parametrize(
    ("query", "problem"),
    [
        ("SELECT * FROM NO_SUCH_TABLE", "NO_SUCH_TABLE"),
        ("SELECT nothing FROM ATTITUDE", "nothing"),
        ("SELCT 1", "syntax error"),
        ("ATTITUDE.roll, VFR_HUD.alt", "fields of one message"),
        ("SELECT * FROM read_csv('/etc/passwd')", "query failed"),
        ("COPY (SELECT 1) TO '/tmp/stolen.csv'", "query failed"),
    ],
)
def test_a_wrong_query_is_reported_in_one_line(flight, query, problem):
    with pytest.raises(InvalidArgumentError, match=problem) as raised:
        ask([flight], query)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("query", ["SELECT 1", "ATTITUDE", "where armed", "ATTITUDE.roll; DROP"])
def test_other_texts_are_not_in_the_short_form(query):
    assert expand_short_form(query) is None


def test_columns_of_one_name_are_kept_apart(flight):
    names, _ = ask(
        [flight], "SELECT a.roll, b.alt, c.alt FROM ATTITUDE a, VFR_HUD b, GLOBAL_POSITION_INT c LIMIT 1"
    )
    assert names == ["roll", "alt", "alt_2"]


def test_variables_of_the_program_are_no_tables(flight):
    with pytest.raises(InvalidArgumentError, match="Table with name connection does not exist"):
        ask([flight], "SELECT * FROM connection")


def table_names_in_two_cases():
    columns = {"TimeUS": [1, 2]}
    return MemoryLog({"ATT": columns | {"Roll": [1.0, 2.0]}, "att": columns | {"Alt": [3, 4], "alt": [5, 6]}})


@pytest.mark.parametrize(
    ("query", "rows"),
    [
        ("SELECT max(Roll) FROM ATT", [(2.0,)]),
        ("SELECT max(TimeUS), count(*) FROM att", [(2, 2)]),
        ("SELECT max(Roll), max(Alt_1) FROM ATT_1 JOIN att_2 USING (TimeUS)", [(2.0, 4)]),
        ("SELECT max(alt_2) FROM att", [(6,)]),
    ],
)
def test_tables_and_columns_that_differ_in_case_only_do_not_hide_each_other(query, rows):
    assert ask([table_names_in_two_cases()], query)[1] == rows


@pytest.mark.parametrize("query", ["SELECT * FROM Att", "SELECT * FROM ATT, att"])
def test_a_table_that_is_not_distinct_is_refused(query):
    with pytest.raises(
        InvalidArgumentError, match="distinguish the tables ATT and att; name them ATT_1 and att_2"
    ):
        ask([table_names_in_two_cases()], query)


def test_a_column_that_is_not_distinct_is_refused():
    with pytest.raises(InvalidArgumentError, match=r'"alt" not found .*"Alt_1"'):
        ask([table_names_in_two_cases()], "SELECT alt FROM att")


@pytest.mark.parametrize(
    ("query", "rows"),
    [
        ("SELECT a.Roll, b.Alt_1 FROM ATT a JOIN att b USING (TimeUS)", [(1.0, 3), (2.0, 4)]),
        ('SELECT ATT.Roll, att."Alt_1" FROM "ATT" JOIN att USING (TimeUS)', [(1.0, 3), (2.0, 4)]),
        ("SELECT max(Roll) FROM ATT -- not att", [(2.0,)]),
        ("SELECT 'att.x', max(Roll) FROM ATT JOIN att USING (TimeUS)", [("att.x", 2.0)]),
    ],
)
def test_both_of_two_tables_that_differ_in_case_only_can_be_named(query, rows):
    assert ask([table_names_in_two_cases()], query)[1] == rows


def test_a_number_of_a_table_that_differs_in_case_only_is_not_the_name_of_another():
    columns = {"TimeUS": [1, 2]}
    log = MemoryLog({"ATT": columns, "att": columns, "att_2": columns | {"X": [7, 8]}})
    assert ask([log], "SELECT max(X) FROM att_2")[1] == [(8,)]
    with pytest.raises(InvalidArgumentError, match="name them ATT_1 and att_3"):
        ask([log], "SELECT * FROM Att")


def test_a_field_named_as_a_state_is_the_field():
    log = MemoryLog({"MODE": {"TimeUS": [1, 2], "Mode": [4, 5]}})
    assert ask([log], "SELECT Mode FROM MODE")[1] == [(4,), (5,)]
    assert [row[1] for row in ask([log], "MODE.Mode")[1]] == [4, 5]
