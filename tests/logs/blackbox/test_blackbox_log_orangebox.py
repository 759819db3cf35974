"""Blackbox logs, compared with the reader of another project."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from mavstack import open_log
from tests.logs.blackbox.writer import MAIN, flight

orangebox = pytest.importorskip("orangebox")

#: Logs of real vehicles, which are not in the repository.
FOLDER = Path(os.environ.get("MAVSTACK_REALDATA", "/nonexistent"))
REAL = sorted(path for path in FOLDER.glob("*") if path.suffix.lower() in (".bbl", ".bfl"))
#: Fields whose encoding orangebox does not read.
PLAIN = tuple(field for field in MAIN if not field[0].startswith("axisF"))


def test_the_same_main_frames(tmp_path):
    path = tmp_path / "log.bbl"
    flights = [flight(seed, main=PLAIN, events=False) for seed in (1, 2)]
    path.write_bytes(b"".join(bytes(written.data) for written in flights))
    log = open_log(path)
    for number in range(2):
        parser = orangebox.Parser.load(str(path), number + 1)
        theirs = [frame.data[: len(PLAIN)] for frame in parser.frames()]
        table = log[f"MAIN[{number}]"]
        for index, (name, *_) in enumerate(PLAIN):
            # orangebox leaves out that numbers have 32 bits.
            ours = np.asarray(table[name]).astype(np.int64) % 2**32
            np.testing.assert_array_equal(ours, [row[index] % 2**32 for row in theirs], name)
        assert parser.headers["Craft name"] == log.info["craft"]


@pytest.mark.flight
@pytest.mark.parametrize("path", REAL, ids=[path.name for path in REAL])
def test_the_same_main_frames_of_real_vehicles(path):
    """Betaflight 4.2 on three boards: each frame that orangebox reads, with all its fields."""
    log = open_log(path)
    assert log.skipped.bad_bytes == 0
    for number in np.unique(log["MAIN"]["_instance"]).tolist():
        parser = orangebox.Parser.load(str(path), number + 1)
        table = log[f"MAIN[{number}]"]
        columns = table.dtype.names
        names = [name for name in parser.field_names if name in columns or name.partition("[")[0] in columns]
        theirs = np.array([frame.data[: len(names)] for frame in parser.frames()], dtype=np.int64)
        ours = np.stack([np.asarray(table[name]).astype(np.int64) for name in names], axis=1)
        np.testing.assert_array_equal(ours, theirs)
