from __future__ import annotations

from math import inf, isnan, nan, pi

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.external import distance_message, obstacle_message, scan_sectors

RANGE = {"min_distance": 0.3, "max_distance": 10.0}


def test_obstacles():
    message = obstacle_message([1.0, inf, nan, 0.1, 20.0, 10.0], 5, increment=10, angle_offset=-30, **RANGE)
    assert message.distances[:7] == (100, 1001, 65_535, 30, 1001, 1000, 65_535)
    assert (message.min_distance, message.max_distance, message.time_usec) == (30, 1000, 5)
    assert (message.increment, message.increment_f, message.angle_offset) == (10, 10.0, -30.0)
    assert message.frame == common.MavFrame.BODY_FRD
    assert obstacle_message([1.0] * 72, 0, **RANGE).increment_f == 5.0


@pytest.mark.parametrize(
    ("distances", "options"),
    [([], {}), ([1.0] * 73, {}), ([1.0] * 72, {"increment": 6}), ([1.0], {"min_distance": 20.0})],
)
def test_impossible_obstacles_are_refused(distances, options):
    with pytest.raises(InvalidArgumentError):
        obstacle_message(distances, 0, **(RANGE | options))


def test_a_scan_of_ros_becomes_sectors():
    """Scans count counter-clockwise, sectors clockwise; the nearest range of a sector counts."""
    ranges = [inf] * 360
    ranges[90] = 3.0  # to the left
    ranges[270], ranges[271] = 5.0, 4.0  # to the right
    ranges[180] = nan
    sectors = scan_sectors(ranges, 0.0, 2 * pi / 360)
    assert (sectors[54], sectors[18], sectors[0]) == (3.0, 4.0, inf)
    assert isnan(scan_sectors([1.0], 0.0, 0.1)[5])


def test_distances():
    message = distance_message(2.5, 2**32 + 7, orientation=25, **RANGE)
    assert (message.current_distance, message.time_boot_ms, message.orientation) == (250, 7, 25)
    assert distance_message(inf, 0, orientation=0, **RANGE).current_distance == 1001
    for wrong in (nan, -1.0):
        with pytest.raises(InvalidArgumentError):
            distance_message(wrong, 0, orientation=0, **RANGE)
