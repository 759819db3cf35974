from __future__ import annotations

from mavstack.cli.common.output import align_columns, coloured, shown_length, wrapped
from mavstack.cli.common.wrapping import (
    UNLIMITED,
    example_that_fits,
    rows_that_fit,
    table_that_fits,
    terminal_columns,
)


def test_lines_break_between_words():
    text = "altitude 34 m above home, heading 120 degrees"
    assert wrapped(text, 20) == ["altitude 34 m above", "home, heading 120", "degrees"]
    assert wrapped(text, 20, "  ") == ["altitude 34 m above", "  home, heading 120", "  degrees"]
    assert wrapped(text, 80) == [text]


def test_a_word_longer_than_a_line_stays_whole():
    assert wrapped("a " + "b" * 30, 20) == ["a", "b" * 30]
    assert wrapped("b" * 30, 20) == ["b" * 30]


def test_colours_have_no_width():
    assert shown_length(coloured("red", "red")) == 3
    assert len(wrapped(f"{coloured('ready to', 'green')} fly", 12)) == 1


ROWS = [
    ("#", "command", "distance", "params"),
    ("1", "takeoff", "", "pitch 15 deg, yaw 90 deg"),
    ("2", "land", "90 m", ""),
]


def test_the_last_column_of_a_table_is_wrapped_below_itself():
    assert table_that_fits(ROWS, 80, right=frozenset({2})) == align_columns(ROWS, right=frozenset({2}))
    assert table_that_fits(ROWS, 44, right=frozenset({2})) == [
        "#  command  distance  params",
        "1  takeoff            pitch 15 deg, yaw 90",
        "                      deg",
        "2  land         90 m",
    ]


def test_a_table_without_room_becomes_texts():
    assert table_that_fits(ROWS, 30, right=frozenset({2})) == [
        "1  takeoff, pitch 15 deg, yaw",
        "   90 deg",
        "2  land, distance 90 m",
    ]


def test_the_width_is_that_of_the_terminal(monkeypatch):
    assert terminal_columns() == 80
    assert terminal_columns(UNLIMITED) == UNLIMITED
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", "61")
    assert terminal_columns(UNLIMITED) == 61
    monkeypatch.setenv("COLUMNS", "3")
    assert terminal_columns() == 40


HEAD = ("NAME", "KIND", "TYPE")
SHORT = (("imu/data", "from vehicle", "sensor_msgs/Imu"), ("state", "from vehicle", ""))
LONG = ("odometry/in", "from vehicle\x1b", "nav_msgs/Odometry ODOMETRY of the estimator")


def in_terminal(monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", str(columns))
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)


def test_rows_of_a_table_that_fits_are_lines(monkeypatch):
    in_terminal(monkeypatch, 50)
    assert rows_that_fit(HEAD, SHORT) == [
        "NAME      KIND          TYPE",
        "imu/data  from vehicle  sensor_msgs/Imu",
        "state     from vehicle",
    ]


def test_rows_of_a_table_that_is_too_wide_have_their_cells_below_the_first(monkeypatch):
    in_terminal(monkeypatch, 50)
    lines = rows_that_fit(HEAD, (*SHORT, LONG))
    assert lines[:5] == ["NAME", "    KIND  TYPE", "imu/data", "    from vehicle  sensor_msgs/Imu", "state"]
    below = ["    from vehicle\ufffd  nav_msgs/Odometry ODOMETRY of", "    the estimator"]
    assert lines[5:] == ["    from vehicle", "odometry/in", *below]


def test_a_pipe_gets_one_line_for_each_row(monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: False, raising=False)
    assert len(rows_that_fit(HEAD, (*SHORT, LONG))) == 4


def test_the_comment_of_an_example_that_is_too_long_is_above_it():
    line = "  mav bridge list             # the mapping table"
    assert example_that_fits(line, 49) == [line]
    assert example_that_fits(line, 48) == ["  # the mapping table", "  mav bridge list"]
    assert example_that_fits("x" * 60, 50) == ["x" * 60]
