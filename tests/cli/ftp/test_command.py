from __future__ import annotations

import json
import random
import re
from dataclasses import replace

import pytest

from mavstack.cli.ftp.command import EXAMPLES
from mavstack.services.ftp import file_crc32
from mavstack.services.ftp.stores import MemoryStore
from mavstack.sim.vehicle_types import VehicleType
from tests.cli.harness import CliHarness, examples_of

LOG = "/APM/LOGS/00000001.BIN"


@pytest.fixture
def harness(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    return CliHarness(monkeypatch)


def random_bytes(size, seed=1):
    return random.Random(seed).randbytes(size)


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_examples_of_the_help_run(mav, monkeypatch, tmp_path, firmware):
    monkeypatch.chdir(tmp_path)
    harness = CliHarness(monkeypatch, (VehicleType.COPTER, firmware))
    (tmp_path / "patrol.lua").write_text("return 1\n")
    harness.put("/fs/microsd/log/2026-11-21/10_00_00.ulg", random_bytes(100))
    top = {"ardupilot": "/APM", "px4": "/fs/microsd"}[firmware]
    harness.put(f"{top}/LOGS/00000001.BIN", random_bytes(5000))
    harness.put(f"{top}/scripts/here.lua", b"return 2\n")
    for words in examples_of(EXAMPLES):
        result = mav(*(word.replace("/APM", top) for word in words))
        assert (result.code, result.err) == (0, ""), words
    assert (tmp_path / "00000001.BIN").read_bytes() == random_bytes(5000)
    assert (tmp_path / "backup" / "here.lua").read_bytes() == b"return 2\n"
    assert harness.file(f"{top}/scripts/old.lua") is None
    assert not harness.has_directory(f"{top}/scripts/modules")


def test_help_shows_the_examples_of_each_action(mav):
    for action in ("ls", "get", "put", "rm", "mkdir", "rename", "crc"):
        assert f"  mav ftp {action}" in mav("ftp", action, "--help").out


def test_ls(mav, harness):
    harness.put(LOG, random_bytes(1500))
    assert mav("ftp", "ls", "/APM").out == "  LOGS/\n  TERRAIN/\n  scripts/\n"
    assert mav("ftp", "ls", "/APM/LOGS").out == "1.5 kB  00000001.BIN\n"
    assert mav("ftp", "ls", LOG).out == "1.5 kB  00000001.BIN\n"
    assert mav("ftp", "ls", "/APM/*/*.BIN").out == f"1.5 kB  {LOG}\n"
    assert json.loads(mav("ftp", "ls", LOG, "--json").out) == [
        {"path": LOG, "name": "00000001.BIN", "type": "file", "size": 1500}
    ]


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (["ls", "/nope"], "not found"),
        (["ls", "/APM/*.xyz"], "no file on the vehicle matches /APM/*.xyz"),
        (["get", "/APM/nope"], "not found"),
        (["get", "/APM/nope*"], "no file on the vehicle matches /APM/nope*"),
        (["crc", "/nope"], "not found"),
        (["rm", "/nope"], "not found"),
        (["mkdir", "/APM/a/b"], "not found"),
        (["rename", "/nope", "/b"], "not found"),
        (["put", "x", "/nope/x"], "not found"),
        (["put", "missing", "/x"], "No such file"),
    ],
)
def test_refusal_is_reported_in_one_line(mav, harness, tmp_path, words, problem):
    (tmp_path / "x").write_text("x")
    result = mav("ftp", *words)
    assert (result.code, result.out) == (1, "")
    assert result.err.startswith("mav ftp: ")
    assert problem in result.err
    assert result.err.count("\n") == 1


@pytest.mark.parametrize("words", [["get", "/APM"], ["rm", "/APM"], ["rm", "-r", "/"], ["get"], ["dance"]])
def test_wrong_usage(mav, harness, words):
    result = mav("ftp", *words)
    assert (result.code, result.out) == (2, "")
    assert result.err


def test_get_to_a_file_and_to_directories(mav, harness, tmp_path):
    harness.put(LOG, random_bytes(3000))
    (tmp_path / "logs").mkdir()
    assert mav("ftp", "get", LOG).out == f"{LOG} -> 00000001.BIN (3.0 kB)\n"
    assert mav("ftp", "get", LOG, "logs").code == 0
    assert mav("ftp", "get", LOG, "new/").code == 0
    printed = json.loads(mav("ftp", "get", LOG, "flight.bin", "--json").out)
    assert printed == {"remote": LOG, "local": "flight.bin", "size": 3000}
    for path in ("00000001.BIN", "logs/00000001.BIN", "new/00000001.BIN", "flight.bin"):
        assert (tmp_path / path).read_bytes() == random_bytes(3000)


def test_get_virtual_and_empty_files(mav, harness, tmp_path):
    assert mav("ftp", "get", "@SYS/uarts.txt").code == 0
    assert (tmp_path / "uarts.txt").read_text()
    assert mav("ftp", "get", "@PARAM/param.pck?withdefaults=1").code == 0
    assert (tmp_path / "param.pck").read_bytes()[:2] == b"\x1c\x67"
    harness.put("/APM/empty", b"")
    assert mav("ftp", "get", "/APM/empty").code == 0
    assert (tmp_path / "empty").read_bytes() == b""


def test_get_a_directory_tree(mav, harness, tmp_path):
    files = {
        "a.lua": random_bytes(10),
        "modules/b.lua": random_bytes(20),
        "modules/deep/c.lua": random_bytes(30),
    }
    for path, data in files.items():
        harness.put(f"/APM/scripts/{path}", data)
    assert mav("ftp", "get", "-r", "/APM/scripts").code == 0
    assert mav("ftp", "get", "-r", "/APM/scripts", "elsewhere").code == 0
    for path, data in files.items():
        assert (tmp_path / "scripts" / path).read_bytes() == data
        assert (tmp_path / "elsewhere" / path).read_bytes() == data
    assert mav("ftp", "rm", "-r", "/APM/scripts").code == 0
    assert not harness.has_directory("/APM/scripts")


def test_put_compares_checksums(mav, harness, tmp_path):
    (tmp_path / "x.lua").write_bytes(random_bytes(9000))
    assert (
        mav("ftp", "put", "x.lua", "/APM/scripts").out == "vehicle 1: x.lua -> /APM/scripts/x.lua (9.0 kB)\n"
    )
    assert harness.file("/APM/scripts/x.lua") == random_bytes(9000)
    crc = json.loads(mav("ftp", "crc", "/APM/scripts/x.lua", "--json").out)["crc"]
    assert crc == file_crc32(random_bytes(9000))
    assert mav("ftp", "crc", "/APM/scripts/x.lua").out == f"{crc:08x}  /APM/scripts/x.lua\n"


@pytest.mark.parametrize("name", ["..", "../../evil", "a/b", "C:evil", "nul\x01", "trailing."])
def test_unsafe_names_are_refused(mav, harness, tmp_path, monkeypatch, name):
    from mavstack.cli.ftp import command as ftp
    from mavstack.services.ftp import Entry

    async def hostile(files, top, depth=0):
        yield top
        yield ftp.RemotePath(f"{top.path}/{name}", Entry(name, size=3))

    monkeypatch.setattr(ftp, "walk", hostile)
    result = mav("ftp", "get", "-r", "/APM/scripts", "into")
    if name == "a/b":  # a name with a slash is two names here, and stays below
        assert not (tmp_path / "b").exists()
    else:
        assert result.code == 1
        assert "cannot be the name of a local file" in result.err
    assert list(tmp_path.parent.glob("**/*evil*")) == []


@pytest.mark.flight
def test_interrupted_download_keeps_the_old_file_and_resumes(mav, harness, tmp_path, monkeypatch):
    data = random_bytes(400_000)
    harness.put(LOG, data)
    target = tmp_path / "00000001.BIN"
    target.write_bytes(b"old")
    cut = CutAfter(harness, 200_000)
    result = mav("ftp", "get", LOG)
    assert result.code == 1
    assert re.search(r"; run it again to resume at [\d.]+ kB$", result.err)
    assert result.err.count("\n") == 1
    assert target.read_bytes() == b"old"
    kept = (tmp_path / ".00000001.BIN.part").stat().st_size
    assert 0 < kept < len(data)
    cut.reconnect()
    assert mav("ftp", "get", LOG).code == 0
    assert target.read_bytes() == data
    assert cut.read_from >= kept
    assert not (tmp_path / ".00000001.BIN.part").exists()


class CutAfter:
    """Cuts the vehicle's link after `size` bytes of a file were read."""

    def __init__(self, harness, size):
        self.harness, self.left, self.read_from = harness, size, 1 << 40
        store = harness.vehicle.storage.files
        opened = store.open_file
        store.open_file = lambda path, **options: self._watch(opened(path, **options))

    def _watch(self, file):
        read = file.read

        def counted(offset, size):
            if size < 1 << 12:  # reads for a checksum are larger
                self.left -= size
                self.read_from = min(self.read_from, offset)
            if self.left < 0:
                self.harness.vehicle.cut(True)
            return read(offset, size)

        file.read = counted
        return file

    def reconnect(self):
        self.left, self.read_from = 1 << 40, 1 << 40
        self.harness.vehicle.cut(False)


@pytest.mark.flight
def test_partial_data_of_another_file_is_downloaded_again(mav, harness, tmp_path):
    harness.put(LOG, random_bytes(200_000, seed=2))
    (tmp_path / ".00000001.BIN.part").write_bytes(random_bytes(100_000, seed=3))
    assert mav("ftp", "get", LOG).code == 0
    assert (tmp_path / "00000001.BIN").read_bytes() == random_bytes(200_000, seed=2)
    (tmp_path / ".00000001.BIN.part").write_bytes(random_bytes(300_000, seed=3))
    assert mav("ftp", "get", LOG).code == 0
    assert (tmp_path / "00000001.BIN").read_bytes() == random_bytes(200_000, seed=2)


def test_refused_download_leaves_no_file(mav, harness, tmp_path):
    assert mav("ftp", "get", "@PARAM/nope").code == 1
    assert list(tmp_path.iterdir()) == []


def test_tree_without_end_makes_no_local_directories(mav, harness, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for number in range(30):
        harness.put(f"/many/{number}/x", b"x")
    result = mav("ftp", "get", "-r", "/many", "--max-entries", 20)
    assert result.code == 1
    assert result.err == (
        "mav ftp: listing /many on 1/1 failed: "
        "the directory has more than the 20 entries allowed; --max-entries allows more\n"
    )
    result = mav("ftp", "get", "-r", "/many", "--max-entries", 40)
    assert result.code == 1
    assert result.err == "mav ftp: /many has more than the 40 entries allowed; --max-entries allows more\n"
    assert list(tmp_path.iterdir()) == []
    assert mav("ftp", "get", "-r", "/many").code == 0
    assert len(list(tmp_path.rglob("x"))) == 30


def test_files_larger_than_the_limit_are_not_downloaded(mav, harness, tmp_path):
    harness.put(LOG, random_bytes(5000))
    harness.put("/APM/LOGS/00000002.BIN", random_bytes(5000))
    result = mav("ftp", "get", LOG, "--max-size", "2k")
    assert result.code == 1
    assert result.err == f"mav ftp: {LOG} has 5.0 kB, more than the 2.0 kB allowed; --max-size allows more\n"
    result = mav("ftp", "get", "-r", "/APM/LOGS", "--max-size", "6k")
    assert "/APM/LOGS has 10.0 kB, more than the 6.0 kB allowed" in result.err
    assert list(tmp_path.iterdir()) == []
    assert mav("ftp", "get", "-r", "/APM/LOGS", "--max-size", "10000").code == 0


def test_a_file_that_outgrows_its_listed_size_ends_with_the_option_that_allows_it(
    mav, harness, tmp_path, monkeypatch
):
    """The listed size of a file does not bound the download of a file that grows."""
    listed = MemoryStore.list_directory

    def list_small_sizes(store, path):
        return [replace(each, size=min(each.size, 100)) for each in listed(store, path)]

    monkeypatch.setattr(MemoryStore, "list_directory", list_small_sizes)
    harness.put(LOG, random_bytes(1_200_000))
    result = mav("ftp", "get", LOG)
    assert result.code == 1
    assert result.err.endswith(
        "the file has 1200000 bytes, more than the 1048776 allowed; --max-size allows more\n"
    )
    assert list(tmp_path.iterdir()) == []
    assert mav("ftp", "get", LOG, "--max-size", "2M").code == 0
    assert (tmp_path / "00000001.BIN").read_bytes() == random_bytes(1_200_000)


def test_a_download_that_takes_too_long_ends_with_the_option_that_allows_it(mav, harness):
    harness.put(LOG, random_bytes(60_000))
    result = mav("ftp", "get", LOG, "--action-timeout", 0.05)
    assert result.code == 1
    assert re.fullmatch(
        rf"mav ftp: downloading {LOG} from 1/1 failed: .*; --action-timeout allows more time\n", result.err
    )


@pytest.mark.parametrize("text", ["0", "-1", "x", "1T", "", "k"])
def test_sizes_that_are_none(mav, text):
    result = mav("ftp", "get", LOG, f"--max-size={text}")
    assert result.code == 2
    assert "is not a number of bytes such as 500k, 20M or 2G" in result.err
