from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.cli.common.character_map import MapObject, draw_map

DEGREE = 111_319.5

places = st.tuples(st.floats(-89, 89), st.floats(-179, 179))


def rows(drawn) -> list[str]:
    return ["".join(cell.symbol for cell in row) for row in drawn.rows]


def test_north_is_up_and_east_is_right():
    track = [(47.0, 8.0), (47.001, 8.0), (47.001, 8.002)]
    drawn = rows(draw_map([MapObject("1", "red", track, track[-1])], 40, 20))
    marked = [(row, text.index("1")) for row, text in enumerate(drawn) if "1" in text]
    assert len(marked) == 1
    row, column = marked[0]
    assert row < 10
    assert column > 30
    below = [text for text in drawn[row + 1 :] if text.strip()]
    assert below, "the way north is drawn"
    assert all(len(text.rstrip()) < 10 for text in below), "it lies in the west"


def test_scale_bar_length():
    drawn = draw_map([MapObject("1", "", [(47.0, 8.0), (47.0, 8.0 + 0.01)])], 60, 20)
    wide = 0.01 * DEGREE * 0.682  # cos(47°)
    metres_a_character = wide * 1.15 / 60
    assert drawn.bar_metres in {1, 2, 5, 10, 20, 50, 100, 200, 500}
    assert abs(drawn.bar * metres_a_character - drawn.bar_metres) <= metres_a_character
    assert drawn.bar <= 0.4 * 60 + 1


def test_single_place_is_centred():
    drawn = rows(draw_map([MapObject("X", "", [], (10.0, 10.0))], 21, 11))
    assert drawn[5][10] == "X" or drawn[5][11] == "X"


def test_empty_map():
    assert rows(draw_map([], 5, 2)) == ["     ", "     "]


@pytest.mark.flight
@given(st.lists(st.lists(places, max_size=5), max_size=4), st.integers(0, 80), st.integers(0, 30))
def test_random_places_fit_any_window(tracks, columns, height):
    things = [MapObject("1", "", track, track[-1] if track else None) for track in tracks]
    drawn = draw_map(things, columns, height)
    assert len(drawn.rows) == height
    assert all(len(row) == columns for row in drawn.rows)
