"""Files of radio parameters."""

from __future__ import annotations

import pytest

from mavstack.errors import ParameterFileError
from mavstack.radio import load_values, parse_values, save_values


def test_values_are_read_back(tmp_path):
    path = tmp_path / "boat.radio"
    save_values(path, {"NETID": 7, "ANT_MODE": 1}, "boat")
    assert load_values(path) == {"NETID": 7, "ANT_MODE": 1}


def test_lists_of_terminal_programs_are_read():
    assert parse_values("S0: FORMAT=26\n\n S3: netid=25  # comment\n") == {"NETID": 25}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("NETID=1\nECC=2", r"x:2: ECC cannot be 2"),
        ("NETID 1", r"x:1: 'NETID 1' is no parameter"),
        ("NETID=1\nNETID=2", r"x:2: NETID is set twice"),
        ("NETID=99999999999", "no parameter"),
    ],
)
def test_bad_lines_are_located(text, words):
    with pytest.raises(ParameterFileError, match=words):
        parse_values(text, "x")


@pytest.mark.parametrize(
    ("data", "words"),
    [(b"\xff\xfe", "not a file"), (b"# none\n", "no parameters"), (b"#" * 70000, "not a file")],
)
def test_other_files_are_refused(tmp_path, data, words):
    path = tmp_path / "x"
    path.write_bytes(data)
    with pytest.raises(ParameterFileError, match=words):
        load_values(path)
