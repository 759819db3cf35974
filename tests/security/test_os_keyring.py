"""Keys in the keyring of the system."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import TYPE_CHECKING

import pytest

from mavstack.errors import MissingExtraError, SigningError
from mavstack.security import SigningKey, key_store, os_keyring
from mavstack.security.key_store import delete_key, find_key, key_names, replace_key, store_key, uses_keyring

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def keys(tmp_path, monkeypatch) -> Path:
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path / "keys")
    return tmp_path / "keys"


@pytest.fixture
def secrets(monkeypatch) -> dict[tuple[str, str], str]:
    """The entries of a keyring in memory."""
    entries: dict[tuple[str, str], str] = {}
    keyring = SimpleNamespace(
        get_password=lambda service, name: entries.get((service, name)),
        set_password=lambda service, name, secret: entries.__setitem__((service, name), secret),
        delete_password=lambda service, name: entries.__delitem__((service, name)),
    )
    monkeypatch.setitem(sys.modules, "keyring", keyring)
    return entries


def test_a_key_is_stored_found_replaced_and_deleted(keys, secrets):
    key, other = SigningKey.generate(), SigningKey.generate()
    path = store_key("fleet", key, keyring=True)
    assert key.secret_bytes().hex() not in path.read_text()
    assert (find_key("fleet"), key_names()) == (key, ["fleet"])
    with pytest.raises(SigningError, match="already"):
        store_key("fleet", other)
    replace_key("fleet", other)
    assert find_key("fleet") == other
    delete_key("fleet")
    assert (secrets, key_names()) == ({}, [])


def test_a_key_that_is_missing_in_the_keyring_is_reported(keys, secrets):
    store_key("fleet", SigningKey.generate(), keyring=True)
    secrets.clear()
    with pytest.raises(SigningError, match="the keyring of the system does not have it"):
        find_key("fleet")
    secrets[os_keyring.SERVICE, "fleet"] = "no key"
    with pytest.raises(SigningError, match="64 hexadecimal digits"):
        find_key("fleet")


def test_an_error_of_the_keyring_shows_no_secret(keys, secrets, monkeypatch):
    def fail(service: str, name: str, secret: str) -> None:
        raise RuntimeError(f"cannot store {secret}")

    key = SigningKey.generate()
    monkeypatch.setattr(sys.modules["keyring"], "set_password", fail)
    with pytest.raises(SigningError, match="RuntimeError") as error:
        store_key("fleet", key, keyring=True)
    assert key.secret_bytes().hex() not in str(error.value)
    assert key_names() == []


def test_without_the_library_its_extra_is_named(keys, monkeypatch):
    monkeypatch.setitem(sys.modules, "keyring", None)
    with pytest.raises(MissingExtraError, match=r"mavstack\[secure\]"):
        store_key("fleet", SigningKey.generate(), keyring=True)


def test_the_environment_selects_the_store(monkeypatch):
    assert not uses_keyring()
    for value, expected in (("keyring", True), ("files", False), ("", False)):
        monkeypatch.setenv("MAVSTACK_KEY_STORE", value)
        assert uses_keyring() is expected
    monkeypatch.setenv("MAVSTACK_KEY_STORE", "cloud")
    with pytest.raises(SigningError, match="must be files or keyring, got 'cloud'"):
        uses_keyring()
