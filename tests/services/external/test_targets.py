from __future__ import annotations

from math import nan, pi

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.external import follow_message, landing_angles, landing_message


def test_landing_targets():
    angles = landing_angles(-1.0, 2.0, 2.0)
    assert angles == pytest.approx((pi / 4, 0.4636), abs=1e-4)
    message = landing_message((-1.0, 2.0, 2.0), 9, angles=angles, number=3)
    assert (message.frame, message.position_valid, message.target_num) == (common.MavFrame.BODY_FRD, 1, 3)
    assert message.distance == pytest.approx(3.0)
    with pytest.raises(InvalidArgumentError):
        landing_message((1.0, 2.0, nan), 0)


def test_targets_to_follow():
    message = follow_message(47.1, 8.5, 500.0, 1234, velocity=(1, 2, 3))
    assert (message.lat, message.lon, message.alt) == (471_000_000, 85_000_000, 500.0)
    assert (message.est_capabilities, message.vel, message.timestamp) == (3, (1, 2, 3), 1234)
    assert follow_message(0, 0, 0, 0).est_capabilities == 1
    with pytest.raises(InvalidArgumentError):
        follow_message(91, 0, 0, 0)
