from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from mavstack.errors import ParameterFileError
from mavstack.files.parameters import (
    FORMATS,
    ParameterFile,
    StoredParameter,
    format_for,
    read_parameters,
    write_parameters,
)

FILE = ParameterFile(
    (StoredParameter("RTL_ALT", 1500), StoredParameter("PSC_POSZ_P", 0.1)), comments=("hello",)
)


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("a.param", "RTL_ALT,1500"),
        ("a.PARM", "RTL_ALT          1500"),
        ("a.params", "1\t1\tRTL_ALT\t1500\t6"),
        ("a.sh", "param set RTL_ALT 1500"),
    ],
)
def test_the_suffix_chooses_the_format(tmp_path, name, line):
    write_parameters(tmp_path / name, FILE)
    text = (tmp_path / name).read_text()
    assert line in text.splitlines()
    assert "# hello" in text
    assert {each.name: each.value for each in read_parameters(tmp_path / name).parameters} == {
        "RTL_ALT": 1500,
        "PSC_POSZ_P": 0.1,
    }


def test_a_format_that_is_named(tmp_path):
    write_parameters(tmp_path / "a.txt", FILE, "mavproxy")
    assert read_parameters(tmp_path / "a.txt", "mavproxy").parameters[0].value == 1500
    with pytest.raises(ParameterFileError, match=r"there is no format 'xml'; there are qgroundcontrol, "):
        write_parameters(tmp_path / "a.txt", FILE, "xml")
    with pytest.raises(ParameterFileError, match=r"a\.txt: the suffix names no format"):
        write_parameters(tmp_path / "a.txt", FILE)
    assert format_for("x.Param") is FORMATS["mission-planner"]


def test_a_file_that_cannot_be_written_stays(tmp_path, monkeypatch):
    path = tmp_path / "a.param"
    path.write_text("A,1\n")

    def broken(self, target):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", broken)
    with pytest.raises(OSError, match="No space"):
        write_parameters(path, FILE)
    assert path.read_text() == "A,1\n"
    assert [each.name for each in tmp_path.iterdir()] == ["a.param"]


def test_other_encodings(tmp_path):
    path = tmp_path / "a.param"
    path.write_bytes("\ufeffA,1\r\n# H\u00f6he\r\n".encode("utf-16-le"))
    assert read_parameters(path).parameters[0].value == 1
    path.write_bytes(b"A,1\n# H\xf6he\n")
    assert read_parameters(path).parameters[0].value == 1


@pytest.mark.parametrize(
    ("data", "problem"),
    [(b"\xa3\x95\x80\x00\x00", "not a text"), (b"A,1\n" * (5 << 20), "larger than 16 MiB")],
    ids=["binary", "huge"],
)
def test_files_that_are_no_parameter_files(tmp_path, data, problem):
    (tmp_path / "x").write_bytes(data)
    with pytest.raises(ParameterFileError, match=problem):
        read_parameters(tmp_path / "x")
    with pytest.raises(FileNotFoundError):
        read_parameters(tmp_path / "missing")


def test_the_error_pickles():
    error = ParameterFileError("it is wrong", "a.param", 3)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.path, again.line) == ("a.param:3: it is wrong", "a.param", 3)


@pytest.mark.parametrize("name", ["A\nB", "A B", "", "A,B", "\x1b[2J"])
def test_an_invalid_name_is_refused(tmp_path, name):
    with pytest.raises(ParameterFileError, match="cannot be a parameter's name"):
        write_parameters(tmp_path / "a.param", ParameterFile((StoredParameter(name, 1),)))
    assert list(tmp_path.iterdir()) == []
