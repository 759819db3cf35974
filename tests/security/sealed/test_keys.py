from __future__ import annotations

import stat
import sys

import pytest

from mavstack.errors import SigningError
from mavstack.security import key_store
from mavstack.security.sealed.keys import new_private_key, public_key, read_peers, read_private_key

DIGITS = "0123456789ABCDEF" * 4


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path / "keys")
    return tmp_path / "keys"


def test_a_new_key_is_its_owners_alone_and_no_signing_key(directory):
    path = new_private_key("boat")
    assert path == directory / "boat.sealed"
    if sys.platform != "win32":
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    secret = read_private_key("boat")
    assert secret == read_private_key(str(path))
    assert len(public_key(secret)) == 32
    assert public_key(secret) != secret
    assert key_store.key_names() == []
    with pytest.raises(SigningError, match="exists"):
        new_private_key("boat")


def test_the_error_of_an_unknown_key_names_the_command():
    with pytest.raises(SigningError, match="mav key new --sealed nobody makes it"):
        read_private_key("nobody")


def test_peers_from_digits_and_files(tmp_path):
    path = tmp_path / "peers.txt"
    path.write_text(f"# the fleet\n{'11' * 32}  boat 7\n\n{'22' * 32}  # nameless\n")
    assert read_peers(f"{DIGITS}, {path}") == {
        bytes.fromhex(DIGITS): DIGITS[:16].lower(),
        b"\x11" * 32: "boat 7",
        b"\x22" * 32: "22" * 8,
    }


@pytest.mark.parametrize("text", ["", " , ", "no-file", DIGITS[:-1]])
def test_texts_that_are_no_peers(text):
    with pytest.raises(SigningError, match="public key"):
        read_peers(text)


@pytest.mark.parametrize("content", ["xyz", DIGITS + "0", "ab" * 32 + "\n\x00"])
def test_a_bad_line_is_named(tmp_path, content):
    path = tmp_path / "peers.txt"
    path.write_text(content)
    with pytest.raises(SigningError, match=r"peers\.txt, line [12]: a public key must have 64"):
        read_peers(str(path))
