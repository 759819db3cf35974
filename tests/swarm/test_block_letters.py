"""Letters as points along their strokes."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.block_letters import _STROKES, text_points


def test_an_l_is_two_strokes():
    points = text_points("L", 10)
    assert points.shape == (10, 2)
    left, bottom = points[:, 0].min(), points[:, 1].min()
    assert ((points[:, 0] == left) | (points[:, 1] == bottom)).all()


@pytest.mark.parametrize("letter", [letter for letter in _STROKES if letter != " "])
def test_each_letter_has_its_height_and_no_two_points_at_one_place(letter):
    points = text_points(letter, 30)
    assert np.ptp(points, axis=0).max() <= 6.0 + 1e-9
    assert len({tuple(point) for point in points.round(6).tolist()}) == 30


def test_foreign_letters_are_refused():
    with pytest.raises(InvalidArgumentError, match="no strokes"):
        text_points("Ж", 3)
