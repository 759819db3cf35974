"""Blackbox logs, compared with the reader of another project."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack import open_log
from tests.logs.blackbox.writer import MAIN, flight

orangebox = pytest.importorskip("orangebox")

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
