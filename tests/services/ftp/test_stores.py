"""File stores: access to files below the root, and nothing else."""

from __future__ import annotations

import os
from contextlib import closing, suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.services.ftp import DirectoryStore, MemoryStore

OUTSIDE = [
    "../secret",
    "a/../../secret",
    "..",
    "/../secret",
    "a\0b",
    "x" * 300,
    "leading/out/secret",
    "out",
    "leading/out",
]


@pytest.fixture
def store(tmp_path) -> DirectoryStore:
    (tmp_path / "secret").write_bytes(b"secret")
    root = tmp_path / "root"
    (root / "leading").mkdir(parents=True)
    (root / "f").write_bytes(b"inside")
    (root / "out").symlink_to(tmp_path / "secret")
    (root / "leading" / "out").symlink_to(tmp_path)
    (root / "link").symlink_to(root / "f")
    return DirectoryStore(root)


@pytest.mark.parametrize("path", OUTSIDE)
def test_nothing_outside_is_read_or_changed(store, path) -> None:
    operations = [
        lambda: store.open_file(path),
        lambda: store.open_file(path, write=True, truncate=True),
        lambda: store.truncate(path, 0),
        lambda: store.list_directory(path),
    ]
    if path not in ("out", "leading/out"):  # the link itself may be removed or renamed
        operations += [
            lambda: store.remove(path),
            lambda: store.rename("f", path),
            lambda: store.rename(path, "g"),
            lambda: store.make_directory(path + "/new"),
            lambda: store.remove_directory(path),
        ]
    for operation in operations:
        with pytest.raises((OSError, ValueError)):
            operation()
    assert (store.root.parent / "secret").read_bytes() == b"secret"
    assert (store.root / "f").read_bytes() == b"inside"
    assert sorted(item.name for item in store.root.parent.iterdir()) == ["root", "secret"]


def test_an_absolute_path_is_below_the_root(store) -> None:
    file = store.open_file("/f")
    assert file.read(2, 100) == b"side"
    file.close()
    with pytest.raises(FileNotFoundError):
        store.open_file("/etc/passwd")


def test_links_inside_are_followed_and_removed_as_links(store) -> None:
    file = store.open_file("link")
    assert file.read(0, 9) == b"inside"
    file.close()
    store.remove("out")
    assert (store.root.parent / "secret").exists()
    names = {entry.name for entry in store.list_directory("/")}
    assert names == {"f", "leading", "link"}


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no fifos here")
def test_what_would_block_is_not_opened(store) -> None:
    os.mkfifo(store.root / "fifo")
    with pytest.raises(OSError, match="not a file"):
        store.open_file("fifo")
    assert "fifo" not in {entry.name for entry in store.list_directory("/")}


@given(st.text(max_size=30) | st.lists(st.sampled_from(["..", ".", "", "f", "out", "leading"])).map("/".join))
def test_no_path_leads_out(tmp_path_factory, path) -> None:
    place = tmp_path_factory.mktemp("store")
    (place / "root" / "leading").mkdir(parents=True)
    (place / "root" / "out").symlink_to(place)
    store = DirectoryStore(place / "root")
    (place / "secret").write_bytes(b"secret")
    (place / "root" / "f").write_bytes(b"inside")
    with suppress(OSError, ValueError), closing(store.open_file(path)) as file:
        assert file.read(0, 100) == b"inside"
    with suppress(OSError, ValueError):
        assert "secret" not in {entry.name for entry in store.list_directory(path)}


@pytest.fixture(params=["directory", "memory"])
def either(request, tmp_path):
    return DirectoryStore(tmp_path) if request.param == "directory" else MemoryStore()


def test_both_stores_do_the_same(either) -> None:
    file = either.open_file("a", write=True, truncate=True)
    file.write(0, b"12345")
    file.write(7, b"89")
    assert (file.size(), file.read(3, 100)) == (9, b"45\0\x0089")
    file.close()
    either.truncate("a", 2)
    either.make_directory("d")
    either.rename("a", "d/b")
    assert [(entry.name, entry.is_directory, entry.size) for entry in either.list_directory("d")] == [
        ("b", False, 2)
    ]
    with pytest.raises(OSError, match="mpty"):
        either.remove_directory("d")
    with pytest.raises(FileExistsError):
        either.make_directory("d")
    with pytest.raises((OSError, ValueError)):
        either.open_file("d", write=True)
    either.remove("d/b")
    either.remove_directory("d")
    for operation in (either.remove, either.remove_directory, either.open_file, either.list_directory):
        with pytest.raises(FileNotFoundError):
            operation("d")
    for operation in (either.remove_directory, either.remove):
        with pytest.raises((OSError, ValueError)):
            operation("/")


def test_both_stores_rename_directories_with_their_content(either) -> None:
    for path in ("empty", "full", "full/inner", "fuller"):
        either.make_directory(path)
    either.open_file("full/inner/f", write=True).close()
    either.rename("empty", "renamed")
    either.rename("full", "renamed/moved")
    assert [entry.name for entry in either.list_directory("/")] == ["fuller", "renamed"]
    assert [entry.name for entry in either.list_directory("renamed/moved/inner")] == ["f"]
    for path, to in (
        ("renamed", "renamed/moved/deeper"),
        ("renamed", "fuller"),
        ("renamed", "none/x"),
        ("/", "x"),
    ):
        with pytest.raises((OSError, ValueError)):
            either.rename(path, to)
    with pytest.raises(FileNotFoundError):
        either.rename("empty", "again")
    assert [entry.name for entry in either.list_directory("renamed/moved/inner")] == ["f"]


def test_a_directory_with_virtual_files_is_not_renamed() -> None:
    store = MemoryStore(virtual={"@PARAM/param.pck": lambda: b"packed"})
    with pytest.raises(PermissionError):
        store.rename("@PARAM", "other")


def test_virtual_files_are_made_when_opened() -> None:
    made = []
    store = MemoryStore(virtual={"@PARAM/param.pck": lambda: made.append(1) or b"packed"})
    assert not made
    assert store.open_file("@PARAM/param.pck").read(0, 100) == b"packed"
    with pytest.raises(PermissionError):
        store.open_file("@PARAM/param.pck", write=True)
    with pytest.raises(PermissionError):
        store.remove("@PARAM/param.pck")
    assert [entry.name for entry in store.list_directory("@PARAM")] == ["param.pck"]


def test_memory_is_bounded() -> None:
    store = MemoryStore({"f": b""}, capacity=None)
    with pytest.raises(OSError, match="too long"):
        store.open_file("f", write=True).write(4_000_000_000, b"x")
    with pytest.raises(OSError, match="too long"):
        store.truncate("f", 4_000_000_000)
