"""`mav key list` and `mav key remove` with keys of sealed links."""

from __future__ import annotations

import io
import json

import pytest

from mavstack.errors import MissingExtraError
from mavstack.security import key_store
from mavstack.security.sealed import keys as sealed_keys


@pytest.fixture(autouse=True)
def keys(tmp_path, monkeypatch):
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path / "keys")
    return tmp_path / "keys"


def listed(mav) -> list[tuple[str, str]]:
    return [(row["name"], row["kind"]) for row in json.loads(mav("key", "list", "--json").out)]


def test_keys_of_sealed_links_are_listed_with_the_begin_of_their_public_key(mav, keys):
    mav("key", "new", "--sealed", "boat")
    mav("key", "new", "fleet")
    (keys / "broken.sealed").write_text("no key")
    assert listed(mav) == [("boat", "sealed"), ("broken", "sealed"), ("fleet", "signing")]
    public = mav("key", "public", "boat").out
    result = mav("key", "list")
    lines = result.out.splitlines()
    assert lines[1].split() == ["boat", "sealed", public[:16]]
    assert "hexadecimal" in lines[2]
    assert (keys / "boat.sealed").read_text().strip() not in result.out


def test_keys_of_sealed_links_are_listed_and_removed_without_the_extra(mav, keys, monkeypatch):
    mav("key", "new", "--sealed", "boat")

    def missing(_key):
        raise MissingExtraError("a sealed link", "secure")

    monkeypatch.setattr(sealed_keys, "public_key", missing)
    (row,) = json.loads(mav("key", "list", "--json").out)
    assert (row["fingerprint"], "secure" in row["problem"]) == (None, True)
    assert mav("key", "remove", "boat", "--yes").code == 0
    assert listed(mav) == []


def test_a_key_of_sealed_links_is_removed_after_confirmation(mav, keys, monkeypatch):
    mav("key", "new", "--sealed", "boat")
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    assert mav("key", "remove", "boat").code == 2
    assert listed(mav) == [("boat", "sealed")]
    result = mav("key", "remove", "boat", "--yes", "--json")
    assert json.loads(result.out) == {"removed": "boat", "kind": "sealed"}
    assert listed(mav) == []


@pytest.mark.parametrize(("kind", "left"), [("signing", "sealed"), ("sealed", "signing")])
def test_of_two_keys_with_one_name_the_kind_is_needed(mav, kind, left):
    mav("key", "new", "--sealed", "boat")
    mav("key", "new", "boat")
    result = mav("key", "remove", "boat", "--yes")
    assert (result.code, "--kind signing or --kind sealed" in result.err) == (2, True)
    assert len(listed(mav)) == 2
    assert mav("key", "remove", "boat", "--yes", "--kind", kind).code == 0
    assert listed(mav) == [("boat", left)]


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("boat", "--kind", "signing"), "no signing key 'boat'"),
        (("fleet", "--kind", "sealed"), "no key 'fleet' of sealed links"),
    ],
)
def test_a_key_of_the_other_kind_is_left_alone(mav, words, problem):
    mav("key", "new", "--sealed", "boat")
    mav("key", "new", "fleet")
    result = mav("key", "remove", *words, "--yes")
    assert (result.code, problem in result.err) == (1, True)
    assert listed(mav) == [("boat", "sealed"), ("fleet", "signing")]
