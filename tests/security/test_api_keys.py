from __future__ import annotations

import pytest

from mavstack.errors import SigningError
from mavstack.security import SigningKey, key_store
from mavstack.security.api_keys import read_api_key


def test_the_text_of_a_file(tmp_path):
    path = tmp_path / "key.txt"
    path.write_text(" ados_secret\n")
    assert read_api_key(str(path)) == "ados_secret"


def test_the_digits_of_a_signing_key(tmp_path, monkeypatch):
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path)
    SigningKey(bytes(range(32))).save(tmp_path / "fleet.key")
    assert read_api_key("fleet") == read_api_key(str(tmp_path / "fleet.key")) == bytes(range(32)).hex()


@pytest.mark.parametrize("content", [b"", b" \n", b"\xff", b"a\nb", b"x" * 4097])
def test_files_without_a_key(tmp_path, content):
    path = tmp_path / "key.txt"
    path.write_bytes(content)
    with pytest.raises(SigningError, match="cannot read the API key"):
        read_api_key(str(path))


def test_an_unknown_name(tmp_path, monkeypatch):
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path)
    with pytest.raises(SigningError, match="there is no signing key 'nobody'"):
        read_api_key("nobody")
