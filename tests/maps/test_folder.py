from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.maps import MapArchive, MapError
from mavstack.maps.folder import default_folder, list_maps, map_path, remove_map


def test_maps_of_a_folder(tmp_path, caplog):
    assert list_maps(tmp_path / "none") == []
    for name in ("b", "a"):
        MapArchive.create(map_path(tmp_path, name)).close()
    (tmp_path / "broken.mbtiles").write_bytes(b"no archive" * 100)
    (tmp_path / ".hidden.mbtiles").touch()
    (tmp_path / "notes.txt").touch()
    assert [facts.name for facts in list_maps(tmp_path)] == ["a", "b"]
    assert "broken.mbtiles failed: file is not a database" in caplog.text


@pytest.mark.parametrize("name", ["", "..", "../a", "a/b", ".a", "a\n", "x" * 80, "ä"])
def test_names_that_would_leave_the_folder(tmp_path, name):
    with pytest.raises(InvalidArgumentError, match="names of maps"):
        map_path(tmp_path, name)


def test_the_folder_of_the_user(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    assert default_folder().name == "maps"


def test_maps_are_removed(tmp_path):
    path = map_path(tmp_path, "a")
    path.touch()
    remove_map(path)
    with pytest.raises(MapError, match=r"removing .*a\.mbtiles failed: No such file"):
        remove_map(path)
