from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mavstack.sim.payloads.picture import HEIGHT, WIDTH, draw, read_time


@given(st.integers(0, 2**48 - 1))
def test_the_time_of_a_picture_is_read_back(milliseconds):
    assert read_time(draw(milliseconds / 1000, 0.0, 0.0)) == int(milliseconds / 1000 * 1000) / 1000


def test_a_smaller_picture_has_the_time_too():
    picture = draw(1_800_000_000.123, 0.3, -0.1)[::2, ::2]
    assert abs(read_time(np.ascontiguousarray(picture)) - 1_800_000_000.123) < 0.002


def test_the_horizon_follows_the_attitude():
    level, high = draw(0, 0.0, 0.0), draw(0, 0.0, 0.3)
    middle = (HEIGHT // 2 - 20, WIDTH // 4)
    assert level[middle][2] > level[middle][0]
    assert (draw(0, 0.0, -0.3)[middle][0], high[HEIGHT // 2 + 20, WIDTH // 4][2]) == (110, 200)
