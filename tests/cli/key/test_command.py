"""`mav key`: keys on this machine, and the key of a vehicle."""

from __future__ import annotations

import io
import json
import stat
import sys
from typing import TYPE_CHECKING

import pytest

from mavstack.cli.key.command import EXAMPLES
from mavstack.security import SigningKey, key_store
from tests.cli.harness import COPTER, PX4_COPTER, examples_of

if TYPE_CHECKING:
    from pathlib import Path

URL = "udpin://127.0.0.1:14550"
FIRMWARES = pytest.mark.parametrize("kind", [COPTER, PX4_COPTER], ids=["ArduPilot", "PX4"])


@pytest.fixture
def keys(tmp_path, monkeypatch) -> Path:
    """The user's key directory, which does not exist yet."""
    directory = tmp_path / "config" / "keys"
    monkeypatch.setattr(key_store, "key_directory", lambda: directory)
    return directory


def test_a_new_key_is_random_and_its_owners_alone(mav, keys):
    for name in ("fleet", "other"):
        result = mav("key", "new", name)
        path = keys / f"{name}.key"
        assert (result.code, result.err) == (0, "")
        assert result.out == f"{path} made; commands take it with --key {name}\n"
        assert path.read_text().strip() not in result.out
        if sys.platform != "win32":
            assert [stat.S_IMODE(each.stat().st_mode) for each in (keys, path)] == [0o700, 0o600]
    assert SigningKey.load(keys / "fleet.key") != SigningKey.load(keys / "other.key")


def test_a_key_is_never_overwritten(mav, keys):
    mav("key", "new", "fleet")
    before = SigningKey.load(keys / "fleet.key")
    result = mav("key", "new", "fleet")
    assert (result.code, result.out) == (1, "")
    assert result.err == f"mav key: there is a signing key 'fleet' already: {keys / 'fleet.key'}\n"
    assert SigningKey.load(keys / "fleet.key") == before


@pytest.mark.parametrize("name", ["a/b", "..", ".hidden", "-x", "", "fleet.key", "a b", "\x1b[2J", "x" * 65])
def test_a_bad_name_is_refused(mav, keys, name):
    for action in ("new", "remove"):
        assert mav("key", action, "--", name).code == 1
    assert not keys.exists()


def test_a_key_of_a_passphrase(mav, keys, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO("correct horse\nmore\n"))
    assert mav("key", "new", "club", "--passphrase").code == 0
    assert SigningKey.load(keys / "club.key") == SigningKey.from_passphrase("correct horse")
    for stdin in (io.StringIO("\n"), None):
        monkeypatch.setattr("sys.stdin", stdin)
        assert mav("key", "new", "empty", "--passphrase").code == 2


def test_the_keys_are_listed_without_their_secrets(mav, keys):
    assert mav("key", "list").err == "there is no key; mav key new NAME makes one\n"
    mav("key", "new", "fleet")
    (keys / "broken.key").write_text("not a key")
    fingerprint = SigningKey.load(keys / "fleet.key").fingerprint
    broken, fleet = json.loads(mav("key", "list", "--json").out)
    assert fleet == {"name": "fleet", "kind": "signing", "fingerprint": fingerprint, "problem": None}
    assert broken["name"] == "broken"
    assert "hexadecimal" in broken["problem"]
    lines = mav("key", "list").out.splitlines()
    assert lines[0].split() == ["NAME", "KIND", "FINGERPRINT"]
    assert lines[2].split() == ["fleet", "signing", fingerprint]


def test_a_key_is_removed_after_confirmation(mav, keys, monkeypatch):
    mav("key", "new", "fleet")
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    assert mav("key", "remove", "fleet").code == 2
    assert (keys / "fleet.key").exists()
    assert mav("key", "remove", "fleet", "--yes").code == 0
    assert not (keys / "fleet.key").exists()
    result = mav("key", "remove", "fleet", "--yes")
    assert (result.code, "no signing key 'fleet'" in result.err) == (1, True)


@FIRMWARES
def test_a_vehicle_gets_a_key_another_one_and_none(mav, keys, simulate, kind):
    vehicles = simulate(kind, ready=False)
    for name in ("fleet", "next"):
        mav("key", "new", name)
    result = mav("key", "install", "fleet", URL, "--yes")
    assert (result.code, result.err) == (0, "")
    assert result.out == "vehicle 1: signs and verifies with the key fleet; reach it with --key fleet\n"
    assert vehicles.vehicle.signing_keys.key == SigningKey.load(keys / "fleet.key")
    result = mav("key", "install", "next", URL, "--key", "fleet", "--json")
    assert json.loads(result.out)["key"] == "next"
    assert mav("param", "get", "LOG_BACKEND_TYPE", "--url", URL, "--key", "fleet").code == 1
    result = mav("key", "off", URL, "--key", "next")
    assert (result.code, result.out) == (0, "vehicle 1: signing turned off\n")
    assert vehicles.vehicle.signing_keys.key is None


def test_a_first_key_is_sent_only_after_confirmation(mav, keys, simulate, monkeypatch):
    vehicles = simulate(ready=False)
    mav("key", "new", "fleet")
    monkeypatch.setattr("sys.stdin", io.StringIO("y\n"))
    result = mav("key", "install", "fleet", URL)
    assert (result.code, result.out) == (2, "")
    assert result.err == "mav key: add --yes to send a first key in the clear without confirmation\n"
    assert vehicles.vehicle.signing_keys.key is None


def test_a_vehicle_with_a_key_wants_to_know_it(mav, keys, simulate):
    simulate(ready=False)
    for name in ("fleet", "other"):
        mav("key", "new", name)
    mav("key", "install", "fleet", URL, "--yes")
    result = mav("key", "install", "other", URL, "--yes")
    assert result.err == "mav key: vehicle 1: it has a key already; name its present key with --key\n"
    result = mav("key", "install", "other", URL, "--key", "other")
    assert "signatures are missing or made with another key" in result.err
    assert mav("key", "off", URL).code == 2


def test_an_armed_vehicle_takes_no_key(mav, keys, simulate):
    vehicles = simulate(ready=False)
    mav("key", "new", "fleet")
    vehicles.vehicle.autopilot.arm(force=True)
    result = mav("key", "install", "fleet", URL, "--yes")
    assert (result.code, "disarm it first" in result.err) == (1, True)


def test_the_examples_run(mav, keys, simulate, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO("correct horse\n"))
    simulate(ready=False)
    mav("key", "new", "next")
    for words in examples_of(EXAMPLES):
        if "/dev/ttyACM0" not in words:
            yes = ["--yes"] if "remove" in words else []
            assert mav(*words, *yes).code == 0 or "already" in words, words
