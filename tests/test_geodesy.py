from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.sim.motion import LocalFrame

LATITUDES = st.floats(-80, 80)
LONGITUDES = st.floats(-180, 180)
METRES = st.floats(-50_000, 50_000)


def earth_centred(latitude: float, longitude: float, height: float = 0.0) -> tuple[float, float, float]:
    """Return Earth-centred coordinates, computed independently of the code under test."""
    axis, squared = 6378137.0, 6.69437999014e-3
    sine, cosine = math.sin(math.radians(latitude)), math.cos(math.radians(latitude))
    across = axis / math.sqrt(1 - squared * sine * sine)
    turn = math.radians(longitude)
    return (
        (across + height) * cosine * math.cos(turn),
        (across + height) * cosine * math.sin(turn),
        (across * (1 - squared) + height) * sine,
    )


@given(LATITUDES, LONGITUDES, METRES, METRES, st.floats(-1000, 1000))
def test_global_and_local_round_trip(latitude, longitude, north, east, down):
    frame = LocalFrame(latitude, longitude, 100)
    assert frame.to_local(*frame.to_global(north, east, down)) == pytest.approx((north, east, down), abs=1e-3)


@given(LATITUDES, LONGITUDES, METRES, METRES)
def test_distances_match_the_ellipsoid(latitude, longitude, north, east):
    frame = LocalFrame(latitude, longitude, 0)
    position = frame.to_global(north, east, 0)
    chord = math.dist(earth_centred(latitude, longitude), earth_centred(position[0], position[1]))
    flat = math.hypot(north, east)
    assert chord == pytest.approx(flat, rel=1e-3, abs=0.01)


def test_across_the_date_line():
    frame = LocalFrame(0, 179.999, 0)
    _, east, _ = frame.to_local(0, -179.999, 0)
    assert east == pytest.approx(222.6, abs=0.5)
    assert frame.to_global(0, 300, 0)[1] < -179


@pytest.mark.parametrize("latitude", [90.0, -90.0])
def test_poles_give_finite_results(latitude):
    frame = LocalFrame(latitude, 0, 0)
    assert all(math.isfinite(value) for value in frame.to_global(100, 100, 0))
    assert all(math.isfinite(value) for value in frame.to_local(latitude, 10, 0))


def test_repr():
    assert repr(LocalFrame(1.5, 2.5, 3.5)) == "LocalFrame(1.5, 2.5, 3.5)"
