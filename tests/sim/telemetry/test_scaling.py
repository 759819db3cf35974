"""Conversion of numbers of any size to the range of their fields."""

from __future__ import annotations

from math import inf, nan, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.sim.telemetry import scaling

ANY_FLOAT = st.floats(allow_nan=True, allow_infinity=True)
RANGES = [
    (scaling.uint8, 0, 255),
    (scaling.int16, -32768, 32767),
    (scaling.uint16, 0, 65535),
    (scaling.int32, -(2**31), 2**31 - 1),
    (scaling.uint32, 0, 2**32 - 1),
    (scaling.percent, -1, 100),
    (scaling.degrees_e7, -(2**31), 2**31 - 1),
    (scaling.centidegrees, 0, 65535),
]


@pytest.mark.fast_cases(4)
@pytest.mark.parametrize(("scale", "low", "high"), RANGES, ids=lambda value: getattr(value, "__name__", ""))
@given(value=ANY_FLOAT)
def test_result_is_in_range(scale, low, high, value):
    result = scale(value)
    assert isinstance(result, int)
    assert low <= result <= high


@pytest.mark.parametrize(
    ("scale", "value", "expected"),
    [
        (scaling.int16, 1.6, 2),
        (scaling.int16, -1.6, -2),
        (scaling.int16, 1e9, 32767),
        (scaling.int16, -inf, -32768),
        (scaling.uint16, 65534.0, 65534),
        (scaling.uint16, 65535.0, 65534),
        (scaling.uint16, -3.0, 0),
        (scaling.uint16, nan, 65535),
        (scaling.int32, -1e12, -(2**31)),
        (scaling.uint32, 1e12, 2**32 - 1),
        (scaling.percent, 0.505, 50),
        (scaling.percent, 7.0, 100),
        (scaling.percent, nan, -1),
        (scaling.degrees_e7, 47.3977418, 473977418),
        (scaling.centidegrees, pi / 2, 9000),
        (scaling.centidegrees, -pi / 2, 27000),
        (scaling.centidegrees, 2 * pi, 0),
        (scaling.centidegrees, nan, 65535),
    ],
)
def test_rounding_clipping_and_unknown(scale, value, expected):
    assert scale(value) == expected


@given(value=st.floats(-100.0, 100.0))
def test_whole_degrees_match_the_direction(value):
    assert 0 <= scaling.whole_degrees(value) < 360
    assert abs((scaling.whole_degrees(value) * pi / 180 - value + pi) % (2 * pi) - pi) < 0.02


def test_unknown_marker_argument():
    assert scaling.int16(nan, 32767) == 32767
