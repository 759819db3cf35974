"""The cache of metadata files: verified, bounded, and no error if it cannot be used."""

from __future__ import annotations

import lzma
import os

from mavstack.files.parameter_metadata import MetadataCache, cache
from mavstack.services.ftp import file_crc32

CONTENT = b'{"parameters": [{"name": "A"}]}'


def test_files_are_found_by_their_crc(tmp_path):
    kept, data = MetadataCache(tmp_path / "new" / "folder"), lzma.compress(CONTENT)
    assert kept.find_crc(1, file_crc32(CONTENT)) is None
    kept.store_crc(1, file_crc32(CONTENT), data)
    kept.store_crc(1, file_crc32(data), data)
    assert kept.find_crc(1, file_crc32(CONTENT)) == kept.find_crc(1, file_crc32(data)) == data
    assert kept.find_crc(2, file_crc32(CONTENT)) is None


def test_damaged_files_are_not_used(tmp_path):
    kept, crc = MetadataCache(tmp_path), file_crc32(CONTENT)
    for damage in (b"", CONTENT[:-1], lzma.compress(CONTENT)[:-3]):
        kept.store_crc(1, crc, CONTENT)
        [path] = tmp_path.iterdir()
        path.write_bytes(damage)
        assert kept.find_crc(1, crc) is None


def test_the_oldest_files_are_removed(tmp_path, monkeypatch):
    monkeypatch.setattr(cache, "MAX_FILES", 3)
    kept = MetadataCache(tmp_path)
    for number in range(3):
        kept.store(f"key{number}", b"x")
        os.utime(tmp_path / f"key{number}.metadata", (number, number))
    kept.store("key3", b"x")
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        f"key{number}.metadata" for number in (1, 2, 3)
    ]


def test_the_newest_files_of_a_type_are_found_whatever_their_crc(tmp_path):
    files = MetadataCache(tmp_path)
    for age, (kind, name) in enumerate([(4, b"new"), (1, b"parameters"), (4, b"old"), (4, b"oldest")]):
        files.store_crc(kind, age, name)
        os.utime(tmp_path / f"type{kind}-{age:08x}.metadata", (1000 - age, 1000 - age))
    assert files.newest(4, 2) == [b"new", b"old"]
    assert MetadataCache(tmp_path / "none").newest(4, 2) == []


def test_keys_stay_in_the_folder(tmp_path):
    kept = MetadataCache(tmp_path / "cache")
    kept.store("../outside", b"x")
    kept.store("a/b", b"x")
    assert list(tmp_path.iterdir()) == []
    assert kept.find("../outside") is None


def test_a_folder_that_cannot_be_used_is_no_error(tmp_path):
    (tmp_path / "file").write_text("x")
    kept = MetadataCache(tmp_path / "file")
    kept.store("key", b"x")
    assert kept.find("key") is None
