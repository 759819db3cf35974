"""The geoid: heights of known places, and the borders of the grid."""

from __future__ import annotations

import pytest

from mavstack.bridges.core.geoid import undulation


@pytest.mark.parametrize(
    ("latitude", "longitude", "height", "error"),
    [
        # Values of EGM96 from NGA's own calculator.
        (38.6281550, 269.7791550, -31.628, 0.1),
        (-14.6212170, 305.0211140, -2.969, 0.1),
        (46.8743190, 102.4487290, -43.575, 0.3),
        (-23.6174460, 133.8747120, 15.871, 0.3),
        (38.6254730, 359.9995000, 50.066, 0.3),
        (-0.4667440, 0.0023000, 17.329, 0.1),
    ],
)
def test_known_heights(latitude: float, longitude: float, height: float, error: float) -> None:
    assert undulation(latitude, longitude) == pytest.approx(height, abs=error)


def test_longitudes_wrap_and_poles_end() -> None:
    assert undulation(10.0, -180.0) == undulation(10.0, 180.0) == undulation(10.0, 540.0)
    assert undulation(90.0, 0.0) == pytest.approx(13.6, abs=0.1)
    assert undulation(95.0, 0.0) == undulation(90.0, 0.0)
    assert undulation(-90.0, 77.0) == pytest.approx(-29.5, abs=0.1)
