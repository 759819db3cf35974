"""`mav key identity`, `offer` and `accept`."""

from __future__ import annotations

import json

import pytest

from mavstack.security import key_store


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path / "keys")
    return tmp_path


def test_a_key_goes_from_one_station_to_another(mav, folder):
    public = {
        name: json.loads(mav("key", "identity", name, "--json").out)["public"]
        for name in ("ann", "bob", "eve")
    }
    mav("key", "new", "fleet")
    file = str(folder / "fleet.offer")
    result = mav("key", "offer", "fleet", "--identity", "ann", "--to", public["bob"], "-o", file)
    assert (result.code, result.err) == (0, "")
    wrong = mav("key", "accept", file, "copy", "--identity", "bob", "--from", public["eve"])
    assert (wrong.code, "another station signed it" in wrong.err) == (1, True)
    taken = mav("key", "accept", file, "fleet", "--identity", "bob", "--from", public["ann"])
    assert (taken.code, "already" in taken.err) == (1, True)
    result = mav("key", "accept", file, "copy", "--identity", "bob", "--from", public["ann"])
    assert (result.code, result.err) == (0, "")
    assert key_store.find_key("copy") == key_store.find_key("fleet")
    again = mav("key", "accept", file, "again", "--identity", "bob", "--from", public["ann"])
    assert (again.code, "not newer" in again.err) == (1, True)


def test_an_offer_is_not_used_up_for_a_name_that_a_key_in_the_keyring_has(mav, folder):
    public = json.loads(mav("key", "identity", "ann", "--json").out)["public"]
    mav("key", "new", "fleet")
    file = str(folder / "fleet.offer")
    assert mav("key", "offer", "fleet", "--identity", "ann", "--to", public, "-o", file).code == 0
    (folder / "keys" / "other.keyring").touch()
    accept = ("--identity", "ann", "--from", public)
    assert "already" in mav("key", "accept", file, "other", *accept).err
    assert mav("key", "accept", file, "copy", *accept).code == 0


def test_problems_are_reported_in_one_line(mav, folder):
    mav("key", "identity", "ann")
    assert "already" in mav("key", "identity", "ann").err
    mav("key", "new", "fleet")
    (folder / "bad").write_text("no hex")
    for other in ("missing", "bad"):
        result = mav(
            "key", "offer", "fleet", "--identity", "ann", "--to", str(folder / other), "-o", str(folder / "o")
        )
        assert (result.code, len(result.err.splitlines())) == (1, 1)
    assert not (folder / "o").exists()
