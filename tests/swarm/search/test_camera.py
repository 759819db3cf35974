"""The ground that a camera sees."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.search.camera import Camera


def test_footprint_and_spacing():
    camera = Camera(horizontal_view=90.0, vertical_view=60.0, width=4000)
    assert camera.footprint(50.0) == pytest.approx((100.0, 57.735), abs=0.001)
    assert camera.spacing(50.0, 0.7) == pytest.approx(30.0)
    assert camera.trigger_distance(50.0, 0.8) == pytest.approx(11.547, abs=0.001)
    assert camera.pixel_size(50.0) == pytest.approx(0.025)
    assert Camera().pixel_size(50.0) is None


def test_wrong_measures_are_refused():
    with pytest.raises(InvalidArgumentError, match="horizontal_view must be more than 0"):
        Camera(horizontal_view=180.0)
    with pytest.raises(InvalidArgumentError, match="overlap must be at least 0"):
        Camera().spacing(50.0, 1.0)
    with pytest.raises(InvalidArgumentError, match="height must be finite"):
        Camera().footprint(0.0)
