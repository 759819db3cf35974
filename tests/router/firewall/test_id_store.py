"""The file with the assigned system ids."""

from __future__ import annotations

import stat

import pytest

from mavstack.errors import RouterConfigError
from mavstack.router.firewall.id_store import MAX_FILE_SIZE, IdStore, ids_path
from mavstack.security import key_store


def test_ids_are_read_back_and_merged(tmp_path):
    store = IdStore(tmp_path / "new" / "router.ids")
    assert store.load() == {}
    store.store({"CN=ann": 200})
    store.store({"CN=b\u00f6b": 201})
    assert store.load() == {"CN=ann": 200, "CN=b\u00f6b": 201}
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o700


@pytest.mark.parametrize(
    "text", ["", "{", "[1]", '{"a": 0}', '{"a": 256}', '{"a": true}', '{"a": "1"}', "[" * 50_000]
)
def test_a_damaged_file_is_reported_and_stays(tmp_path, text):
    path = tmp_path / "router.ids"
    path.write_text(text)
    for use in (IdStore(path).load, lambda: IdStore(path).store({"a": 1})):
        with pytest.raises(
            RouterConfigError, match=r"router\.ids: no assigned system ids: mend or remove it"
        ):
            use()
    assert path.read_text() == text


def test_a_file_that_cannot_be_used_is_reported(tmp_path):
    (tmp_path / "router.ids").mkdir()
    with pytest.raises(RouterConfigError, match="cannot open"):
        IdStore(tmp_path / "router.ids").load()
    (tmp_path / "file").touch()
    with pytest.raises(RouterConfigError, match="cannot"):
        IdStore(tmp_path / "file" / "router.ids").store({"a": 1})
    large = tmp_path / "large.ids"
    large.write_bytes(b" " * (MAX_FILE_SIZE + 1))
    with pytest.raises(RouterConfigError, match="no assigned system ids"):
        IdStore(large).load()


def test_the_file_is_beside_the_keys(tmp_path, monkeypatch):
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path / "keys")
    monkeypatch.setattr("mavstack.router.firewall.id_store.key_directory", key_store.key_directory)
    assert ids_path() == tmp_path / "router.ids"
