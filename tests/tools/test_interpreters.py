"""The newest Python of the machine is found among programs that may be broken, too new or not a release."""

from __future__ import annotations

import sys

import pytest

from tools import interpreters

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the interpreters are shell scripts")

VERSIONS = [(3, 11), (3, 12), (3, 13), (3, 14)]


@pytest.fixture
def folders(tmp_path):
    """Two folders of programs; the returned function adds an interpreter that prints a version."""
    places = [tmp_path / "first", tmp_path / "second"]
    for place in places:
        place.mkdir()

    def add(number, name, output, code=0):
        path = places[number] / name
        path.write_text(f"#!/bin/sh\necho '{output}'\nexit {code}\n")
        path.chmod(0o755)
        return path

    return places, add


def test_the_newest_one_counts_wherever_it_is(folders):
    places, add = folders
    add(0, "python3.12", "3 12")
    newest = add(1, "python3.13", "3 13")
    assert interpreters.newest(places, VERSIONS, (3, 11)) == newest


def test_none_is_newer(folders):
    places, add = folders
    add(0, "python3.11", "3 11")
    assert interpreters.newest(places, VERSIONS, (3, 11)) is None


@pytest.mark.parametrize(
    ("name", "output", "code"),
    [
        ("python3.15", "3 15", 0),
        ("python3.14", "", 0),
        ("python3.14", "pyenv: python3.14: command not found", 127),
        ("python3.14", "3 11", 0),
    ],
    ids=["not supported yet", "a preview", "the shim of a version that is not there", "another version"],
)
def test_what_cannot_be_used_is_passed_over(folders, name, output, code):
    places, add = folders
    add(0, name, output, code)
    usable = add(1, "python3.12", "3 12")
    assert interpreters.newest(places, VERSIONS, (3, 11)) == usable


def test_an_interpreter_of_this_machine_is_asked_for_its_version():
    """By the program itself, instead of by a stand-in."""
    assert interpreters._version(sys.executable) == sys.version_info[:2]


def test_supported_versions_are_those_of_the_classifiers():
    assert interpreters.supported()[0] == (3, 11)
    assert sys.version_info[:2] in interpreters.supported()
