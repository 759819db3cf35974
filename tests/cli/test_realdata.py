"""Real logs, where there are some: the counts are those of an independent reader."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

FOLDER = os.environ.get("MAVSTACK_REALDATA", "")

pytestmark = pytest.mark.skipif(not FOLDER, reason="MAVSTACK_REALDATA names no folder")


@pytest.mark.parametrize(
    ("name", "packets", "kinds", "duration", "sources"),
    [
        ("ardusub_small.tlog", 35912, 46, 263.4, ["1/1", "1/100", "1/194", "1/220", "255/190"]),
        ("dronekit_flight_replay.tlog", 75477, 35, 1377.0, ["1/1", "51/68", "255/0"]),
        ("mavlink_server_00025.tlog", 30439, 31, 245.8, ["1/1", "1/194", "255/240"]),
        ("node_mavlink_data.mavlink", 1476, 24, None, ["1/1"]),
        ("pymavlink_mav2_battery.tlog", 1, 1, 0.0, ["1/1"]),
        ("sitl_px4main.tlog", 6640, 40, 15.0, ["1/1"]),
    ],
)
def test_counts(mav, name, packets, kinds, duration, sources):
    result = mav("watch", Path(FOLDER) / name, "--once", "--json")
    assert result.code == 0
    summary = json.loads(result.out)
    assert summary["packets"] == packets
    assert len(summary["messages"]) + len(summary["unknown"]) == kinds
    assert summary["sources"] == sources
    assert summary["signed"] == 0
    assert summary["duration_s"] == (None if duration is None else pytest.approx(duration, abs=0.1))
    assert sum(summary["messages"].values()) + sum(summary["unknown"].values()) == packets


@pytest.mark.parametrize("name", ["ardusub_small.tlog", "sitl_px4main.tlog", "dronekit_flight_replay.tlog"])
def test_one_line_per_packet(mav, name):
    path = Path(FOLDER) / name
    summary = json.loads(mav("watch", path, "--once", "--json").out)
    lines = mav("watch", path, "--json").out.splitlines()
    assert len(lines) == summary["packets"]
    times = [json.loads(line)["time"] for line in lines]
    assert all(times)


def test_old_log_of_another_dialect(mav):
    result = mav("watch", Path(FOLDER) / "pymavlink_js_capture.mavlink", "--once", "--json")
    assert json.loads(result.out)["packets"] == 0
    assert result.code == 0


@pytest.mark.parametrize(
    "name", ["ardusub_small.BIN", "pyulog_sample_log_small.ulg", "pymavlink_common.pcapng"]
)
def test_other_log_formats_are_refused(mav, name):
    result = mav("watch", Path(FOLDER) / name, "--once")
    assert result.code == 1
    assert "not a stream of MAVLink packets" in result.err
