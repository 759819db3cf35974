"""The tracks of the vehicles in a log."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.logs.tracks import distances, tracks
from tests.logs.files import encoded, stamped


def test_each_vehicle_has_a_track(flight):
    first, second = tracks(flight)
    assert (first.system, second.system) == (1, 2)
    assert (first.source, len(first)) == ("GLOBAL_POSITION_INT", 10)
    assert first.latitudes[:2] == pytest.approx([47.0, 47.0001])
    assert first.altitudes[[0, -1]].tolist() == [488.0, 497.0]
    assert second.latitudes[0] == pytest.approx(48.0)
    assert np.diff(first.times) == pytest.approx(1.0)
    assert first.distance == pytest.approx(9 * 11.12, rel=1e-3)


def test_distances_are_those_of_the_sphere():
    one, half = np.array([1.0, 0.0]), np.array([0.0, 90.0])
    zero = np.zeros(2)
    assert distances(zero, zero, one, half) == pytest.approx([111_195.08, 10_007_557.2], rel=1e-6)


def test_positions_without_a_fix_are_left_out(tmp_path):
    fixes = [(0, 47.0, 8.0), (1, 47.0, 8.0), (3, 0.0, 0.0), (3, 91.0, 8.0), (3, 47.0, 8.0), (4, 47.1, 8.0)]
    messages = [
        common.GpsRawInt(fix_type=fix, lat=round(lat * 1e7), lon=round(lon * 1e7), alt=5000)
        for fix, lat, lon in fixes
    ]
    path = tmp_path / "gps.tlog"
    path.write_bytes(stamped(encoded(messages)))
    (track,) = tracks(open_log(path, "common"))
    assert track.source == "GPS_RAW_INT"
    assert track.latitudes.tolist() == pytest.approx([47.0, 47.1])
    assert track.altitudes.tolist() == [5.0, 5.0]


def test_a_log_without_positions_has_no_track(tmp_path):
    path = tmp_path / "none.tlog"
    path.write_bytes(stamped(encoded([common.Attitude()])))
    assert tracks(open_log(path, "common")) == []


def test_a_long_track_is_thinned(flight):
    track = tracks(flight)[0]
    thin = track.thinned(4)
    assert thin.altitudes.tolist() == [488.0, 491.0, 494.0, 497.0]
    assert track.thinned(10) is track
