"""Virtual files beside real ones: visibility, changes, and hostile paths."""

from __future__ import annotations

from errno import EINVAL, ENOSPC

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import FileDenied
from mavstack.services.ftp import DirectoryStore, Entry, MemoryStore, OverlayStore, VirtualFile
from tests.services.ftp.harness import FtpHarness

HOSTILE = ["..", "../x", "/../x", "sys/../../x", "a\0b", "y" * 300, "sys/" + "y" * 300]


class Source:
    """A virtual file that remembers what was asked and written."""

    def __init__(self, content: bytes = b"made") -> None:
        self.content = content
        self.queries: list[str] = []
        self.written: list[bytes] = []
        self.refuses = False

    def read(self, query: str) -> bytes:
        self.queries.append(query)
        return self.content + query.encode()

    def write(self, content: bytes) -> None:
        if self.refuses:
            raise OSError(EINVAL, "refused")
        self.written.append(content)


@pytest.fixture
def source() -> Source:
    return Source()


@pytest.fixture(params=["memory", "directory"])
def store(request, tmp_path, source) -> OverlayStore:
    if request.param == "memory":
        base = MemoryStore({"real/a": b"A", "real/shadowed": b"old", "top": b"T"})
    else:
        (tmp_path / "real").mkdir()
        (tmp_path / "real" / "a").write_bytes(b"A")
        (tmp_path / "real" / "shadowed").write_bytes(b"old")
        (tmp_path / "top").write_bytes(b"T")
        base = DirectoryStore(tmp_path)
    return OverlayStore(
        base,
        {
            "sys/info": VirtualFile(source.read),
            "sys/asked": VirtualFile(source.read, source.write, size=lambda: 77, takes_query=True),
            "real/shadowed": VirtualFile(source.read),
        },
    )


def content(store: OverlayStore, path: str) -> bytes:
    file = store.open_file(path)
    data = file.read(0, file.size())
    file.close()
    return data


def test_a_listing_has_both(store) -> None:
    assert [(entry.name, entry.is_directory) for entry in store.list_directory("/")] == [
        ("real", True),
        ("sys", True),
        ("top", False),
    ]
    found = {entry.name: entry.size for entry in store.list_directory("real")}
    assert found == {"a": 1, "shadowed": 4}
    assert list(store.list_directory("/sys/")) == [Entry("asked", size=77), Entry("info", size=4)]


def test_a_virtual_file_is_seen_where_both_are(store) -> None:
    assert content(store, "real/shadowed") == b"made"
    assert content(store, "real/a") == b"A"


def test_who_reads_sees_one_moment(store, source) -> None:
    file = store.open_file("sys/info")
    assert file.read(0, 2) == b"ma"
    source.content = b"another"
    assert file.read(2, 9) == b"de"
    assert content(store, "sys/info") == b"another"


def test_a_query_reaches_only_who_takes_one(store, source) -> None:
    assert content(store, "sys/asked?start=1&count=2") == b"madestart=1&count=2"
    assert source.queries[-1] == "start=1&count=2"
    with pytest.raises(FileNotFoundError):
        store.open_file("sys/info?x=1")


def test_what_is_written_comes_whole_at_the_end(store, source) -> None:
    file = store.open_file("sys/asked", write=True, truncate=True)
    file.write(3, b"def")
    file.write(0, b"abc")
    assert source.written == []
    with pytest.raises(OSError, match="open for writing"):
        file.read(0, 3)
    file.close()
    assert source.written == [b"abcdef"]
    with pytest.raises(PermissionError):
        store.open_file("sys/info", write=True)


def test_virtual_files_and_their_directories_stay(store) -> None:
    for change in (
        lambda: store.remove("sys/info"),
        lambda: store.truncate("sys/asked", 0),
        lambda: store.rename("sys/info", "real/x"),
        lambda: store.remove_directory("sys"),
        lambda: store.remove_directory("real"),
        lambda: store.rename("real", "moved"),
        lambda: store.open_file("sys/new", write=True),
        lambda: store.make_directory("sys/new"),
        lambda: store.rename("top", "sys/top"),
    ):
        with pytest.raises(PermissionError):
            change()
    for change in (
        lambda: store.rename("top", "sys/info"),
        lambda: store.rename("top", "sys"),
        lambda: store.make_directory("sys"),
        lambda: store.make_directory("sys/info"),
    ):
        with pytest.raises(FileExistsError):
            change()


def test_the_base_is_changed_through_it(store) -> None:
    file = store.open_file("real/new", write=True)
    file.write(0, b"new")
    file.close()
    store.make_directory("more")
    store.rename("real/new", "more/newer")
    store.truncate("more/newer", 2)
    assert content(store, "more/newer") == b"ne"
    store.remove("more/newer")
    store.remove_directory("more")
    assert "more" not in {entry.name for entry in store.list_directory("/")}


def test_a_file_is_no_directory_and_a_directory_no_file(store) -> None:
    with pytest.raises(NotADirectoryError):
        store.list_directory("sys/info")
    with pytest.raises(OSError, match="directory"):
        store.open_file("sys")
    with pytest.raises(FileNotFoundError):
        store.open_file("sys/nothing")
    with pytest.raises(FileNotFoundError):
        store.list_directory("nowhere")


@pytest.mark.parametrize("path", HOSTILE)
def test_hostile_paths_are_refused(store, path) -> None:
    for operation in (
        lambda: store.open_file(path),
        lambda: store.open_file(path, write=True),
        lambda: store.list_directory(path),
        lambda: store.remove(path),
        lambda: store.rename("top", path),
        lambda: store.rename(path, "x"),
        lambda: store.truncate(path, 1),
        lambda: store.make_directory(path + "/z"),
        lambda: store.remove_directory(path),
    ):
        with pytest.raises((OSError, ValueError)):
            operation()
    assert content(store, "top") == b"T"


@given(path=st.text(max_size=400), to=st.text(max_size=60), size=st.integers(0, 99))
def test_any_path_does_something_or_raises_oserror(path, to, size) -> None:
    store = OverlayStore(MemoryStore({"a/b": b"x"}), {"a/v": VirtualFile(lambda query: b"v")})
    for operation in (
        lambda: store.open_file(path),
        lambda: store.list_directory(path),
        lambda: store.rename(path, to),
        lambda: store.make_directory(path),
        lambda: store.remove_directory(path),
        lambda: store.truncate(path, size),
        lambda: store.remove(path),
    ):
        try:
            operation()
        except OSError:
            continue


def test_a_file_that_cannot_be_made_is_listed_and_refused(store) -> None:
    def broken(query: str) -> bytes:
        raise OSError(EINVAL, "not now")

    store.add("sys/broken", VirtualFile(broken))
    assert Entry("broken", size=0) in store.list_directory("sys")
    with pytest.raises(OSError, match="not now"):
        store.open_file("sys/broken")


def test_over_the_network(source) -> None:
    store = OverlayStore(
        MemoryStore({"real/a": b"A" * 1000}),
        {"@SYS/info": VirtualFile(source.read), "@SYS/up": VirtualFile(lambda query: b"abc", source.write)},
    )
    harness = FtpHarness(store=store)
    listing = harness.run(harness.client.list_directory("/", harness.now)).result()
    assert [entry.name for entry in listing] == ["@SYS", "real"]
    assert harness.run(harness.client.download("@SYS/info", harness.now)).result() == b"made"
    harness.run(harness.client.upload("@SYS/up", b"abc", harness.now)).result()
    assert source.written == [b"abc"]
    source.refuses = True
    refused = harness.run(harness.client.upload("@SYS/up", b"abc", harness.now))
    assert source.written == [b"abc"]
    assert refused.error is None or isinstance(refused.error, FileDenied)
    for operation in (
        harness.client.remove("@SYS/info", harness.now),
        harness.client.download("no", harness.now),
    ):
        assert isinstance(harness.run(operation).error, FileDenied)
    assert len(harness.server.sessions) == 0


def test_an_upload_that_no_client_ends_harms_no_client(source) -> None:
    source.refuses = True
    store = OverlayStore(MemoryStore(), {"up": VirtualFile(source.read, source.write)})
    harness = FtpHarness(store=store)
    operation = harness.client.upload("up", b"x" * 2000, harness.now)
    harness.ground.engine.touch(harness.client)
    harness.network.run(lambda: len(harness.server.sessions) > 0, timeout=5)
    for pipe in harness.pipes:
        pipe.cut = True
    harness.network.run(lambda: operation.done and len(harness.server.sessions) == 0, timeout=120)
    assert len(harness.server.sessions) == 0


def test_a_store_in_memory_can_be_full() -> None:
    store = MemoryStore({"a": b"x" * 60}, capacity=100)
    file = store.open_file("b", write=True)
    file.write(0, b"y" * 40)
    with pytest.raises(OSError, match="full") as refused:
        file.write(40, b"z")
    assert refused.value.errno == ENOSPC
    with pytest.raises(OSError, match="full"):
        store.truncate("a", 61)
    file.write(0, b"w" * 40)
    store.remove("a")
    file.write(40, b"z" * 60)
    assert len(store["b"]) == 100
