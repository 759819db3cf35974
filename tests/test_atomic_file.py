"""Files that are written completely or not at all."""

from __future__ import annotations

import os
import sys

import pytest

from mavstack.atomic_file import write_file_atomically


def test_a_file_is_created_and_replaced(tmp_path) -> None:
    target = tmp_path / "f"
    write_file_atomically(target, b"one")
    write_file_atomically(str(target), "zwei ä\n")
    assert target.read_bytes() == "zwei ä\n".encode()
    assert [item.name for item in tmp_path.iterdir()] == ["f"]


def test_a_failure_leaves_the_old_content_and_no_temporary_file(tmp_path, monkeypatch) -> None:
    target = tmp_path / "f"
    target.write_bytes(b"old")

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        write_file_atomically(target, b"new")
    assert target.read_bytes() == b"old"
    assert [item.name for item in tmp_path.iterdir()] == ["f"]


def test_links_and_permissions_are_kept(tmp_path) -> None:
    target, link = tmp_path / "f", tmp_path / "link"
    target.write_bytes(b"old")
    target.chmod(0o600)
    link.symlink_to(target)
    write_file_atomically(link, b"new")
    assert link.is_symlink()
    assert target.read_bytes() == b"new"
    assert target.stat().st_mode & 0o777 == 0o600


@pytest.mark.skipif(sys.platform == "win32", reason="permissions of POSIX")
def test_a_private_file_is_never_readable_by_others(tmp_path) -> None:
    before = os.umask(0)
    try:
        write_file_atomically(tmp_path / "secret", "secret", private=True)
        write_file_atomically(tmp_path / "other", "other")
    finally:
        os.umask(before)
    assert [(tmp_path / name).stat().st_mode & 0o777 for name in ("secret", "other")] == [0o600, 0o666]


def test_a_device_is_written_directly() -> None:
    write_file_atomically(os.devnull, b"data")


def test_a_missing_directory_is_an_error(tmp_path) -> None:
    with pytest.raises(FileNotFoundError, match=r"No such file or directory: '\S+no/f'$"):
        write_file_atomically(tmp_path / "no" / "f", b"")
