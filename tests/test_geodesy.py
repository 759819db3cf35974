from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.geodesy import METRES_PER_DEGREE, LocalFrame, distance, offset, offset_location

LATITUDES = st.floats(-80, 80)
LONGITUDES = st.floats(-180, 180)
METRES = st.floats(-50_000, 50_000)
SOURCE = Path(__file__).parents[1] / "src" / "mavstack"
#: A radius of the Earth in metres, or the length of a degree, with or without separators.
SIZE_OF_THE_EARTH = re.compile(r"\b6_?3(78|71|56)_?\d{3}(\.|\b)|\b111_?[0-4]\d\d\.\d|\b0\.0111\d{3,}")


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


@given(LATITUDES, LONGITUDES, METRES, METRES)
def test_the_sphere_is_wrong_by_less_than_six_parts_in_a_thousand(latitude, longitude, north, east):
    to_latitude, to_longitude, _ = LocalFrame(latitude, longitude, 0).to_global(north, east, 0)
    found = offset(latitude, longitude, to_latitude, to_longitude)
    assert found == pytest.approx((north, east), rel=0.006, abs=0.01)


@given(LATITUDES, LONGITUDES, METRES, METRES)
def test_an_offset_leads_back(latitude, longitude, north, east):
    there = offset_location(latitude, longitude, north, east)
    assert offset(latitude, longitude, *there) == pytest.approx((north, east), abs=1e-3)
    assert distance(latitude, longitude, *there) == pytest.approx(math.hypot(north, east), abs=1e-3)


def test_distances_cross_the_date_line():
    assert distance(0, 179.5, 0, -179.5) == pytest.approx(METRES_PER_DEGREE)


def test_the_size_of_the_earth_is_declared_once():
    holders = {
        path.relative_to(SOURCE).as_posix()
        for path in SOURCE.rglob("*.py")
        if "dialects" not in path.parts and SIZE_OF_THE_EARTH.search(path.read_text("utf-8"))
    }
    assert holders == {"geodesy.py"}
