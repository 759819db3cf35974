"""Conversions of many logs: resumed, from and to URLs, and on a Dask cluster."""

from __future__ import annotations

import json
from argparse import Namespace
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool

import fsspec
import pytest
from fsspec.implementations.memory import MemoryFileSystem

from mavstack.cli.data import conversion
from mavstack.cli.data.conversion import ConvertedLogs, Job
from mavstack.errors import LogError
from tests.logs.flights import flight_tlog


@pytest.fixture
def logs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a.tlog", "b.tlog"):
        (tmp_path / name).write_bytes(flight_tlog())
    return tmp_path


def test_a_conversion_is_resumed(mav, logs):
    words = ("data", "convert", "a.tlog", "--to", "geojson", "-o", "out", "--resume", "done.txt")
    (logs / "out").mkdir()
    assert mav(*words).code == 0
    again = mav(*words)
    assert (again.code, again.out) == (0, "")
    assert "1 log was converted before" in again.err
    (logs / "a.tlog").write_bytes(flight_tlog() * 2)
    assert "40 points" in mav(*words).out, "a log that has changed is converted again"
    assert len((logs / "done.txt").read_text().splitlines()) == 2


def test_a_file_that_is_no_list_of_logs_is_refused(logs):
    (logs / "done.txt").write_text("not json\n")
    with pytest.raises(LogError, match="no list of converted logs"):
        ConvertedLogs("done.txt")
    (logs / "done.txt").unlink()
    assert not ConvertedLogs("done.txt").has(Job("a.tlog", "x"))


def test_logs_and_results_at_urls(mav, logs):
    url = f"file://{logs}"
    result = mav("data", "convert", f"{url}/a.tlog", "--to", "kml", "-o", f"{url}/out/a.kml")
    assert (result.code, result.err) == (0, "")
    assert (logs / "out" / "a.kml").read_text().startswith("<?xml")
    result = mav("data", "convert", f"{url}/a.tlog", "--to", "parquet", "-o", f"{url}/set")
    assert result.code == 0
    assert list((logs / "set").rglob("message=ATTITUDE/*.parquet"))
    assert mav("data", "convert", f"{url}/a.tlog", "--to", "kml").code == 2
    nothing = mav("data", "convert", f"{url}/*.ulg", "--to", "kml", "-o", "out")
    assert (nothing.code, "no file matches" in nothing.err) == (1, True)
    unknown = mav("data", "convert", "nonsense://x/a.tlog", "--to", "kml", "-o", "out")
    assert (unknown.code, "cannot open nonsense://x/a.tlog" in unknown.err) == (1, True)
    missing = mav("data", "convert", f"{url}/c.tlog", "--to", "kml", "-o", "out")
    assert (missing.code, missing.err.count("\n")) == (1, 1)


@pytest.mark.flight
@pytest.mark.filterwarnings("ignore")
def test_a_dask_cluster_writes_one_dataset(mav, logs):
    import duckdb
    from distributed import LocalCluster

    (logs / "bad.tlog").write_bytes(b"no log")
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None) as cluster:
        result = mav(
            "data", "convert", "a.tlog", "b.tlog", "bad.tlog", "--to", "parquet", "-o", "set",
            "--dask", cluster.scheduler_address, "--json",
        )  # fmt: skip
    assert result.code == 1
    outcomes = {outcome["file"]: outcome for outcome in map(json.loads, result.out.splitlines())}
    assert "nothing to write" in outcomes["bad.tlog"]["problem"]
    count = duckdb.sql("SELECT count(*) FROM 'set/**/message=ATTITUDE/*.parquet'").fetchall()
    assert count == [(20,)]


def test_a_cluster_that_is_not_there_is_reported(mav, logs, monkeypatch):
    import distributed

    def refuse(address, timeout):
        raise OSError(f"timed out connecting to {address}")

    monkeypatch.setattr(distributed, "Client", refuse)
    result = mav("data", "convert", "a.tlog", "--to", "kml", "--dask", "tcp://127.0.0.1:9")
    assert (result.code, "cannot reach the Dask scheduler" in result.err) == (1, True)


def test_a_list_that_was_cut_off_is_continued(mav, logs):
    words = ("data", "convert", "a.tlog", "--to", "geojson", "-o", "a.geojson", "--resume", "done.txt")
    assert mav(*words).code == 0
    line = (logs / "done.txt").read_text()
    (logs / "done.txt").write_text(line + line[:20])
    assert "converted before" in mav(*words).err
    mav("data", "convert", "b.tlog", "--to", "geojson", "-o", "b.geojson", "--resume", "done.txt")
    assert [json.loads(each)[0] for each in (logs / "done.txt").read_text().splitlines()] == [
        "a.tlog",
        "b.tlog",
    ]


@pytest.mark.parametrize("content", ["5\n", "[[1]]\n", '{"a": 1}\nnot json\n'])
def test_other_json_is_no_list_of_logs(logs, content):
    (logs / "done.txt").write_text(content)
    with pytest.raises(LogError, match="no list of converted logs"):
        ConvertedLogs("done.txt")


def test_a_list_that_cannot_be_written_is_reported(logs):
    known = ConvertedLogs("done.txt")
    (logs / "done.txt").mkdir()
    with pytest.raises(LogError, match=r"cannot write done\.txt"):
        known.add(Job("a.tlog", "x"))


def test_two_logs_never_have_one_target(mav, logs):
    (logs / "other").mkdir()
    (logs / "other" / "a.tlog").write_bytes(flight_tlog())
    (logs / "out").mkdir()
    for words in (("--to", "kml", "-o", "out"), ("--to", "csv", "-o", "out")):
        result = mav("data", "convert", "a.tlog", "other/a.tlog", *words)
        assert (result.code, "a.tlog and other/a.tlog would both be written to out/a" in result.err) == (
            2,
            True,
        )
    assert list((logs / "out").iterdir()) == []


def test_a_process_that_is_killed_fails_its_logs(logs, monkeypatch):
    class Pool:
        def __init__(self, *_, **__):
            self.futures = []

        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def submit(self, *_):
            future = Future()
            future.set_exception(BrokenProcessPool("terminated abruptly"))
            return future

    monkeypatch.setattr(conversion, "ProcessPoolExecutor", Pool)
    jobs = [Job("a.tlog", "a.kml"), Job("b.tlog", "b.kml")]
    outcomes = list(conversion.run_jobs(jobs, Namespace(dask=None, jobs=2)))
    assert {outcome.job for outcome in outcomes} == set(jobs)
    assert all("a process was killed" in outcome.problem for outcome in outcomes)


class StrangeError(Exception):
    """An error of a file system that is no OSError, as those of cloud storages."""


class StrangeFileSystem(MemoryFileSystem):
    protocol = "strange"

    def _open(self, *arguments, **options):
        raise StrangeError("NoSuchBucket: it is gone\nRequest ID: 1")

    def glob(self, path, **options):
        raise StrangeError

    makedirs = get_file = put_file = _open


def test_errors_of_file_systems_are_one_line(mav, logs):
    fsspec.register_implementation("strange", StrangeFileSystem, clobber=True)
    for words, problem in [
        (("strange://x/a.tlog", "-o", "out"), "cannot open strange://x/a.tlog: NoSuchBucket: it is gone"),
        (("a.tlog", "-o", "strange://x/out"), "cannot write strange://x/out: NoSuchBucket: it is gone"),
        (("strange://x/*.tlog", "-o", "out"), "cannot open strange://x/*.tlog: StrangeError"),
    ]:
        result = mav("data", "convert", *words, "--to", "kml")
        assert (result.code, result.err) == (1, f"mav data: {problem}\n")
