"""The recordings in the repository: still equal to the output of their generator, and decoded as expected."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from mavstack.logs import open_log

FOLDER = Path(__file__).parents[2] / "recordings"


def test_recordings_equal_the_output_of_their_generator():
    expected = runpy.run_path(str(FOLDER / "make.py"))["recordings"]()
    assert {name: (FOLDER / name).read_bytes() for name in expected} == expected
    assert max(map(len, expected.values())) < 8000


def test_contents_of_the_flight():
    log = open_log(FOLDER / "flight.tlog")
    assert log.timestamped
    assert log.counts == {
        "ATTITUDE": 25,
        "GLOBAL_POSITION_INT": 24,
        "HEARTBEAT": 18,
        "AHRS": 5,
        "PARAM_VALUE": 5,
        "STATUSTEXT": 1,
    }
    statistics = log.statistics
    assert (statistics.packets, statistics.version_1, statistics.signed) == (79, 7, 1)
    assert log.unknown == {0x4AFFFF: 1}
    assert {source: (item.received, item.lost) for source, item in log.sources.items()} == {
        (1, 1): (66, 1),
        (1, 100): (6, 0),
        (1, 191): (1, 0),
        (255, 190): (6, 0),
    }
    times = log["ATTITUDE"]["_time"]
    assert (np.diff(times) < np.timedelta64(0, "us")).sum() == 1, "the clock was set back once"
    assert log["STATUSTEXT"]["text"].tolist() == ["Landed: café".encode()]
    assert log["PARAM_VALUE"]["param_id"][1] == b"PARAM_5"


def test_contents_of_the_link():
    log = open_log(FOLDER / "link.raw")
    assert not log.timestamped
    assert log.statistics.packets == 42
    assert log.duration == 0
    assert log["ATTITUDE"]["roll"][:2] == pytest.approx(
        open_log(FOLDER / "flight.tlog")["ATTITUDE"]["roll"][:2]
    )
