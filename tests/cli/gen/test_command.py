from __future__ import annotations

import json
import subprocess
import sys
from importlib import import_module

import pytest

from mavstack.codegen.language import LANGUAGES

pytestmark = pytest.mark.usefixtures("plugins")
OWN = """<mavlink>
<include>minimal.xml</include>
<messages>
<message id="12345" name="OWN"><field type="{type}" name="value">value</field></message>
</messages></mavlink>
"""


def test_a_library_is_written_once(mav, tmp_path):
    result = mav("gen", "text", "common", "-o", tmp_path, "--only", "HEARTBEAT,GPS_RAW*")
    assert (result.code, result.out) == (0, f"{tmp_path}: 3 files, 4 changed\n")
    result = mav("gen", "text", "common", "-o", tmp_path, "--only", "HEARTBEAT,GPS_RAW*")
    assert result.out == f"{tmp_path}: 3 files, 0 changed\n"


def test_exclude_and_package(mav, tmp_path):
    result = mav(
        "gen",
        "text",
        "common",
        "-o",
        tmp_path,
        "--only",
        "HEARTBEAT,ATTITUDE",
        "--exclude",
        "HEARTBEAT",
        "--package",
        "org.mine",
        "--json",
    )
    assert json.loads(result.out)["files"] == [
        ".mavgen-text.txt",
        "README.md",
        "messages/attitude.txt",
    ]
    assert (tmp_path / "README.md").read_text() == "# org.mine\n"


def test_check_fails_while_a_file_is_out_of_date(mav, tmp_path):
    words = ("gen", "text", "minimal", "-o", tmp_path)
    result = mav(*words, "--check")
    assert result.code == 1
    assert f"mav gen: out of date: {tmp_path / 'README.md'}" in result.err
    assert not any(tmp_path.iterdir())
    mav(*words)
    assert mav(*words, "--check").code == 0
    (tmp_path / "README.md").write_text("edited")
    assert json.loads(mav(*words, "--check", "--json").out) == {"outdated": [str(tmp_path / "README.md")]}


def test_a_custom_dialect_with_its_includes(mav, tmp_path):
    (tmp_path / "own.xml").write_text(OWN.format(type="uint8_t"))
    assert mav("gen", "text", tmp_path / "own.xml", "-o", tmp_path / "out").code == 0
    assert (tmp_path / "out" / "messages" / "heartbeat.txt").is_file()


def test_an_error_in_a_definition_names_file_and_line(mav, tmp_path):
    (tmp_path / "own.xml").write_text(OWN.format(type="uint7_t"))
    result = mav("gen", "text", tmp_path / "own.xml", "-o", tmp_path / "out")
    assert result.code == 1
    assert f"{tmp_path / 'own.xml'}:4: " in result.err
    assert result.err.count("\n") == 1


def test_a_file_of_the_user_is_overwritten_only_with_force(mav, tmp_path):
    (tmp_path / "README.md").write_text("mine")
    result = mav("gen", "text", "minimal", "-o", tmp_path)
    assert result.code == 1
    assert "README.md was not written by mav gen; choose another folder" in result.err
    assert mav("gen", "text", "minimal", "-o", tmp_path, "--force").code == 0


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("text",), "name a language, a dialect and a folder"),
        (("fortran", "common", "-o", "x"), "got 'fortran'"),
        (("text", "common", "-o", "x", "--only", "NO_SUCH"), "no message matches 'NO_SUCH'"),
        (("text", "no_such_dialect", "-o", "x"), "no_such_dialect"),
    ],
)
def test_wrong_usage_is_one_line(mav, words, problem, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    result = mav("gen", *words)
    assert result.code == 2
    assert problem in result.err
    assert result.err.count("\n") == 1


def test_languages_are_listed(mav):
    assert "text         Plain text\n" in mav("gen", "--list").out
    titles = json.loads(mav("gen", "--list", "--json").out)
    assert titles["text"] == "Plain text"
    assert set(LANGUAGES) <= set(titles)


def test_examples_of_the_help_name_languages_of_this_design():
    text = import_module("mavstack.cli.gen.command").EXAMPLES
    named = {line.split()[2] for line in text.splitlines() if line.startswith("  mav gen ")}
    assert {"c", "typescript", "java", "python", "--list"} <= named


@pytest.mark.flight
def test_generation_imports_nothing_that_takes_longer_than_a_part_of_it(tmp_path):
    words = ["-X", "importtime", "-m", "mavstack", "gen", "lua", "minimal", "-o", str(tmp_path)]
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=True)
    imported = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert "mavstack.codegen.library" in imported
    assert not imported & {"dataclasses", "inspect", "jinja2", "logging", "numpy", "pathlib", "shutil"}
