"""Keys by the name of the user or by the path of their file."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from mavstack.errors import SigningError
from mavstack.security import SigningKey, key_store
from mavstack.security.key_store import find_key, key_directory

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def keys(tmp_path, monkeypatch) -> Path:
    directory = tmp_path / "keys"
    directory.mkdir()
    monkeypatch.setattr(key_store, "key_directory", lambda: directory)
    return directory


def test_a_key_is_found_by_name_and_by_path(keys, tmp_path):
    named, other = SigningKey.generate(), SigningKey.generate()
    named.save(keys / "fleet.key")
    other.save(tmp_path / "other.hex")
    assert find_key("fleet") == named
    assert find_key(str(tmp_path / "other.hex")) == other


def test_a_file_in_the_working_directory_comes_before_a_name(keys, tmp_path, monkeypatch):
    local = SigningKey.generate()
    local.save(tmp_path / "fleet")
    SigningKey.generate().save(keys / "fleet.key")
    monkeypatch.chdir(tmp_path)
    assert find_key("fleet") == local


def test_the_error_for_an_unknown_name_lists_the_known_names(keys):
    for name in ("alpha", "beta"):
        SigningKey.generate().save(keys / f"{name}.key")
    with pytest.raises(SigningError, match=r"no signing key 'gamma'.*keys there: alpha, beta"):
        find_key("gamma")
    with pytest.raises(SigningError, match="cannot read the key file"):
        find_key("folder/gamma")


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="the directory of Linux")
def test_the_directory_of_keys(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert key_directory() == tmp_path / "mavstack" / "keys"
    monkeypatch.delenv("XDG_CONFIG_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert key_directory() == tmp_path / ".config" / "mavstack" / "keys"


@pytest.mark.skipif(sys.platform == "win32", reason="permissions of POSIX")
def test_a_key_that_is_removed_while_it_is_replaced_is_written_for_its_owner_only(keys, monkeypatch):
    path = key_store.store_key("fleet", SigningKey.generate())
    path.unlink()
    monkeypatch.setattr(key_store, "require_stored", lambda name: path)
    key_store.replace_key("fleet", SigningKey.generate())
    assert path.stat().st_mode & 0o077 == 0
