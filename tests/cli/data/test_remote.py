"""Logs at URLs in every action of `mav data`."""

from __future__ import annotations

import json
import tempfile

import fsspec
import pytest

from tests.logs.flights import flight_tlog

URL = "memory://logs/flight.tlog"


@pytest.fixture(autouse=True)
def remote(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    system = fsspec.filesystem("memory")
    system.pipe("/logs/flight.tlog", flight_tlog() + b"junk")
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    yield
    system.rm("/logs", recursive=True)
    assert not list(temporary.glob("mavstack-*/flight.tlog")), "copies are removed"


@pytest.mark.parametrize(
    "words",
    [
        ("info", URL),
        ("messages", URL, "ATTITUDE"),
        ("query", "memory://logs/*.tlog", "SELECT count(*) FROM ATTITUDE"),
        ("report", URL, "-o", "page.html"),
        ("report", URL, "--json"),
        ("plot", URL, "altitude"),
        ("diff", URL, URL),
        ("repair", URL, "-o", "new.tlog"),
    ],
)
def test_a_log_at_a_url(mav, words):
    result = mav("data", *words)
    assert (result.code, "/temporary/" in result.out) == (0, False), result.err
    assert result.out


def test_a_url_is_named_as_it_was_given(mav):
    assert json.loads(mav("data", "info", URL, "--json").out)["file"] == URL
    assert URL in mav("data", "info", URL).out
    strict = mav("data", "query", URL, "ATTITUDE.roll", "--strict")
    assert (strict.code, strict.err) == (1, f"mav data: {URL}: skipped 4 bad bytes\n")
    missing = mav("data", "messages", URL, "NOTHING")
    assert (missing.code, f"{URL} contains no NOTHING" in missing.err) == (1, True)


def test_a_log_that_is_not_there(mav):
    result = mav("data", "info", "memory://logs/none.tlog")
    assert (result.code, result.err.count("\n")) == (1, 1)
    assert "cannot open memory://logs/none.tlog" in result.err


def test_the_report_of_a_url_has_no_place_of_its_own(mav):
    result = mav("data", "report", URL)
    assert (result.code, "needs -o FILE" in result.err) == (2, True)


class OddError(Exception):
    """An exception of a back end without a text, and with an attribute of an unexpected type."""

    def __init__(self):
        super().__init__()
        self.strerror = {"code": 403}

    def __str__(self):
        return "\n"


@pytest.mark.parametrize("method", ["get_file", "glob", "unstrip_protocol"])
def test_exceptions_of_back_ends_are_errors_of_ours(mav, monkeypatch, method):
    def fail(*_arguments, **_options):
        raise OddError

    monkeypatch.setattr(fsspec.filesystem("memory"), method, fail, raising=False)
    pattern = "memory://logs/fl*.tlog" if method != "get_file" else URL
    result = mav("data", "query", pattern, "SELECT count(*) FROM ATTITUDE")
    assert (result.code, result.err.count("\n")) == (1, 1)
    assert "cannot open memory://logs/" in result.err
