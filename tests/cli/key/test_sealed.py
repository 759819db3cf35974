from __future__ import annotations

import json

import pytest

from mavstack.security import key_store
from mavstack.security.sealed.keys import public_key, read_private_key


@pytest.fixture(autouse=True)
def keys(tmp_path, monkeypatch):
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path / "keys")
    return tmp_path / "keys"


def test_a_new_key_shows_its_public_half_alone(mav, keys):
    result = mav("key", "new", "--sealed", "boat")
    assert (result.code, result.err) == (0, "")
    secret = read_private_key("boat")
    assert result.out.splitlines()[-1] == public_key(secret).hex()
    assert secret.hex() not in result.out
    assert mav("key", "public", "boat").out == f"{public_key(secret).hex()}\n"
    assert json.loads(mav("key", "public", "boat", "--json").out) == {"public": public_key(secret).hex()}


def test_json_and_a_name_that_is_taken(mav, keys):
    made = json.loads(mav("key", "new", "--sealed", "boat", "--json").out)
    assert made["path"] == str(keys / "boat.sealed")
    assert mav("key", "new", "--sealed", "boat").code == 1


@pytest.mark.parametrize("option", ["--passphrase", "--keyring"])
def test_options_that_do_not_fit(mav, keys, option):
    result = mav("key", "new", "--sealed", "boat", option)
    assert (result.code, result.out) == (2, "")
    assert not keys.exists()


def test_an_unknown_key(mav):
    result = mav("key", "public", "nobody")
    assert (result.code, result.err.count("\n")) == (1, 1)
    assert "mav key new --sealed nobody makes it" in result.err
