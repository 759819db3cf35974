"""Formations: shapes, spacing, and slots on a course."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.formations import FORMATIONS, Formation, default_spacing, rotate_to_course
from mavstack.swarm.separation import nearest_pair

SHAPES = [name for name in FORMATIONS if name not in ("points", "text")]


def spacing_of(points):
    return nearest_pair(points * (1.0, 1.0, 2.0))[0]  # without the factor of heights


@pytest.mark.parametrize("name", SHAPES)
@given(count=st.integers(3, 60), spacing=st.floats(1.0, 50.0), angle=st.floats(5.0, 90.0))
def test_neighbours_keep_the_spacing(name, count, spacing, angle):
    offsets = Formation(name, spacing=spacing, angle=angle).offsets(count)
    assert offsets.shape == (count, 3)
    assert spacing_of(offsets) == pytest.approx(spacing, rel=1e-6)


@pytest.mark.parametrize("name", ["line", "column", "wedge", "echelon", "diamond"])
def test_the_leader_has_slot_0_and_no_member_is_ahead(name):
    offsets = Formation(name).offsets(9)
    assert offsets[0].tolist() == [0.0, 0.0, 0.0]
    assert offsets[:, 0].max() <= 1e-9


def test_shapes():
    assert Formation("line", spacing=4).offsets(3).tolist() == [[0, 0, 0], [0, 4, 0], [0, -4, 0]]
    assert Formation("column", spacing=4).offsets(2).tolist() == [[0, 0, 0], [-4, 0, 0]]
    wedge = Formation("wedge", spacing=10, angle=45).offsets(3)
    assert wedge[1:, 0] == pytest.approx([-7.07, -7.07], abs=0.01)
    assert wedge[1:, 1] == pytest.approx([7.07, -7.07], abs=0.01)
    circle = Formation("circle", spacing=5).offsets(8)
    assert np.ptp(np.linalg.norm(circle, axis=1)) < 1e-9
    assert Formation("sphere").offsets(20).mean(axis=0) == pytest.approx(np.zeros(3), abs=1.5)


def test_layers_are_heights():
    offsets = Formation("line", layers=3, layer_spacing=5.0).offsets(7)
    assert offsets[:, 2].tolist() == [0, 5, 10, 0, 5, 10, 0]


def test_a_course_turns_clockwise():
    assert rotate_to_course(np.array([[10.0, 0.0, 1.0]]), 90.0)[0] == pytest.approx([0, 10, 1])
    assert Formation("column", spacing=4, rotation=180).offsets(2)[1] == pytest.approx([4, 0, 0])


def test_text_is_drawn_upright_with_the_spacing():
    offsets = Formation("text", text="Hi 5", spacing=3.0).offsets(60)
    assert (offsets[:, 0] == 0.0).all()
    assert spacing_of(offsets) == pytest.approx(3.0)
    assert np.ptp(offsets[:, 1]) > np.ptp(offsets[:, 2])


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"name": "vee"}, "formation must be one of line"),
        ({"name": "line", "spacing": 0.0}, "spacing must be at least 0.1 m"),
        ({"name": "line", "spacing": float("nan")}, "spacing must be at least 0.1 m"),
        ({"name": "wedge", "angle": 0.0}, "angle must be more than 0"),
        ({"name": "line", "layers": 0}, "layers must be at least 1"),
    ],
)
def test_wrong_measures_are_refused(options, text):
    with pytest.raises(InvalidArgumentError, match=text):
        Formation(**options)


def test_wrong_counts_are_refused():
    with pytest.raises(InvalidArgumentError, match="count must be 1 to 1000, got 0"):
        Formation("line").offsets(0)
    with pytest.raises(InvalidArgumentError, match="points has 1 points for 2 vehicles"):
        Formation("points", points=[(0, 0, 0)]).offsets(2)
    with pytest.raises(InvalidArgumentError, match="text has 'Ä'"):
        Formation("text", text="ä").offsets(2)
    with pytest.raises(InvalidArgumentError, match="at least one letter"):
        Formation("text", text=" ").offsets(2)


def test_the_default_spacing_lets_members_exchange_their_slots():
    assert default_spacing("line", 6.8) == 10.0
    for name in ("line", "wedge", "grid", "sphere", "circle"):
        offsets = Formation(name, spacing=default_spacing(name, 6.8)).offsets(9)
        assert nearest_pair(offsets)[0] >= 6.8 * 2**0.5 - 1e-6, name
