"""Arrays of positions are converted as `LocalFrame` converts each."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.geodesy import LocalFrame
from mavstack.swarm.frame import to_global, to_local

METRES = st.floats(-20_000.0, 20_000.0)


@given(
    st.floats(-80.0, 80.0),
    st.floats(-180.0, 180.0),
    st.lists(st.tuples(METRES, METRES, METRES), min_size=1, max_size=5),
)
def test_arrays_equal_the_frame(latitude, longitude, points):
    frame, array = LocalFrame(latitude, longitude, 480.0), np.array(points)
    places = to_global(frame, array)
    for (north, east, up), (lat, lon, altitude) in zip(points, places.tolist(), strict=True):
        expected = frame.to_global(north, east, -up)
        assert (lat, altitude) == pytest.approx((expected[0], expected[2]), abs=1e-8)
        assert (lon - expected[1] + 180.0) % 360.0 == pytest.approx(180.0, abs=1e-8)
        expected_local = frame.to_local(lat, lon, altitude)
        local = to_local(frame, np.array([[lat, lon, altitude]]))[0]
        assert local * (1, 1, -1) == pytest.approx(expected_local, abs=1e-6)
    assert to_local(frame, places) == pytest.approx(array, abs=1e-3)


def test_no_vehicles():
    frame = LocalFrame(47.0, 8.0, 480.0)
    assert to_local(frame, np.empty((0, 3))).shape == to_global(frame, np.empty((0, 3))).shape == (0, 3)
