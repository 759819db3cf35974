"""The options of missions that a planner makes."""

from __future__ import annotations

from argparse import ArgumentTypeError

import pytest

from mavstack.cli.mission.planned import place


def test_places_are_degrees():
    assert place("-33.8568,151.2153") == (-33.8568, 151.2153)


@pytest.mark.parametrize("text", ["", "47", "47,8,9", "47,x", "91,8", "47,181", "nan,8"])
def test_other_texts_are_refused(text):
    with pytest.raises(ArgumentTypeError):
        place(text)
