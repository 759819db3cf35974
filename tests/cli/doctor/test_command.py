from __future__ import annotations

import json
import os
import re
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

import mavstack
from mavstack.cli.doctor import checks


def test_all_checks_pass(mav):
    result = mav("doctor")
    assert (result.code, result.err) == (0, "")
    assert mavstack.__version__ in result.out
    report = json.loads(mav("doctor", "--json").out)
    assert report["ok"] is True
    details = {check["name"]: check["detail"] for check in report["checks"]}
    assert {"core", "udp", "dialects", "numpy"} <= set(details)
    assert re.fullmatch(
        r"the core was built by rustc \d+\.\d+.* of the (system|project.*)", details["toolchain"]
    )
    assert details["mavstack"].endswith(f" in {Path(mavstack.__file__).parent}")


@pytest.mark.skipif(os.name != "posix", reason="the event loop waits for no descriptor")
@pytest.mark.parametrize(("chosen", "reader"), [("native", "a thread of the core"), ("asyncio", "asyncio")])
def test_the_reader_of_udp_links_is_named(mav, monkeypatch, chosen, reader):
    monkeypatch.setenv("MAVSTACK_INPUT", chosen)
    report = json.loads(mav("doctor", "--json").out)
    details = {check["name"]: check["detail"] for check in report["checks"]}
    assert details["input"] == f"UDP, TCP, Unix sockets and serial ports are read by {reader}"
    assert report["ok"] is True


def test_missing_extra_is_reported_and_is_no_failure(mav, monkeypatch):
    def version(name):
        if name == "rich":
            raise PackageNotFoundError(name)
        return "1"

    monkeypatch.setattr(checks, "version", version)
    result = mav("doctor")
    assert result.code == 0
    assert "pip install 'mavstack[cli]'" in result.out


@pytest.mark.parametrize("failing", ["core", "udp"])
def test_failed_check_is_a_failure(mav, monkeypatch, failing):
    def broken():
        raise OSError("out of order")

    replaced = [(name, broken if name == failing else check) for name, check in checks._CHECKS]
    monkeypatch.setattr(checks, "_CHECKS", replaced)
    result = mav("doctor")
    assert result.code == 1
    assert "out of order" in result.out
    assert failing in result.err
    assert json.loads(mav("doctor", "--json").out)["ok"] is False


def test_wrong_checksum_is_found(mav, monkeypatch):
    monkeypatch.setattr("mavstack.wire.crc16", lambda _data: 0)
    assert mav("doctor").code == 1


def test_serial_ports_without_their_library(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "serial.tools.list_ports", None)
    assert isinstance(checks._found_ports(), list)
